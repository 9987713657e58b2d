// The strip that shows a task: what to do, how far it has come, what was learnt.

import { element } from "../common/dom.js";
import { LESSONS } from "./lessons.js";
import { write } from "../common/words.js";

export class TaskStrip {
  /**
   * section: element of the strip; opener: the button that opens and closes it
   * line: element at the edge of the window, which tells of the task while its progress is out of sight
   */
  constructor(section, opener, line) {
    Object.assign(this, { section, opener, line, isInSight: false });
    this.build();
    new IntersectionObserver(([{ isIntersecting }]) => this.see(isIntersecting)).observe(this.goals);
    opener.addEventListener("click", () => this.open(section.hidden));
  }

  build() {
    const button = (text, className = "") => element("button", { type: "button", textContent: text, className });
    const paragraph = (className) => element("p", { className });
    this.choices = LESSONS.map((_, i) => button(String(i + 1)));
    this.forget = button("Reset progress", "quiet");
    this.title = element("h3", { id: "task-title" });
    [this.todo, this.look, this.measure] = ["todo", "look", "measure"].map(paragraph);
    this.start = button("");
    this.start.id = "task-start";
    this.hintText = element("p");
    this.hint = element("details", { id: "task-hint" }, element("summary", { textContent: "Hint" }), this.hintText);
    this.goals = element("ul", { className: "goals" });
    this.room = paragraph("learnt"); // unseen, it holds the room of what was learnt
    this.room.ariaHidden = "true";
    this.outcome = element("p", { id: "task-outcome", className: "outcome", role: "status" });
    this.next = button("Next task");
    this.next.id = "task-next";
    this.section.append(
      element("div", { className: "choices" }, element("h2", { id: "tasks-title", textContent: "Tasks" }), ...this.choices, this.forget),
      element("div", { className: "task" }, this.title, this.todo, this.look, element("div", { className: "actions" }, this.start, this.hint)),
      element("div", { className: "progress" }, this.goals, this.measure, element("div", { className: "room" }, this.room, this.outcome), this.next),
    );
  }

  open(isOpen) {
    this.section.hidden = !isOpen;
    this.opener.setAttribute("aria-expanded", String(isOpen));
    document.body.classList.toggle("teaching", isOpen);
    this.tellBriefly();
  }

  see(isInSight) {
    this.isInSight = isInSight;
    this.tellBriefly();
  }

  tellBriefly() {
    this.line.hidden = this.section.hidden || this.isInSight || !this.line.textContent;
  }

  /** on: {choose(index), start(event's time stamp), forget()} */
  listen(on) {
    this.choices.forEach((choice, i) => choice.addEventListener("click", () => on.choose(i)));
    this.start.addEventListener("click", (event) => on.start(event.timeStamp));
    this.forget.addEventListener("click", () => on.forget());
    this.next.addEventListener("click", () => {
      on.choose((this.index + 1) % LESSONS.length);
      this.start.focus();
    });
  }

  tell({ index, lesson, isBegun, isDone, done, reached, measure, note }) {
    if (this.index !== index) this.turnTo(index, lesson);
    this.choices.forEach((choice, i) => {
      choice.classList.toggle("done", done[i]);
      choice.setAttribute("aria-label", `Task ${i + 1}: ${LESSONS[i].title}${done[i] ? ", done" : ""}`);
    });
    this.start.textContent = isBegun ? "Reset the sliders" : "Begin: set the sliders";
    [...this.goals.children].forEach((goal, i) => {
      goal.classList.toggle("done", reached[i]);
      goal.firstChild.textContent = reached[i] ? "Done: " : "To do: ";
    });
    write(this.measure, measure || "\u00a0");
    const outcome = isDone ? lesson.learnt : note;
    if (this.told !== outcome) write(this.outcome, outcome);
    this.told = outcome;
    this.outcome.classList.toggle("done", isDone);
    this.next.textContent = index < LESSONS.length - 1 ? "Next task" : "Back to task 1";
    this.next.style.visibility = isDone ? "visible" : "hidden";
    write(this.line, isBegun ? `Task ${index + 1}, ${reached.filter(Boolean).length} of ${reached.length} done. ${isDone ? "The explanation is above." : note || measure}` : "");
    this.tellBriefly();
  }

  /** Show another task. */
  turnTo(index, lesson) {
    this.index = index;
    this.choices.forEach((choice, i) => choice.setAttribute("aria-current", String(i === index)));
    this.title.textContent = `${index + 1}. ${lesson.title}`;
    write(this.todo, lesson.todo);
    write(this.look, `Look at: ${lesson.look}`);
    write(this.hintText, lesson.hint);
    write(this.room, lesson.learnt);
    this.hint.open = false;
    this.goals.replaceChildren(...lesson.goals.map(({ text }) => {
      const words = element("span");
      write(words, text);
      return element("li", {}, element("span", { className: "hidden" }), words);
    }));
  }
}
