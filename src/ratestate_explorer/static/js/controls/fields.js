// The parameters: an entry with a unit, and a slider.

import { element } from "../common/dom.js";
import { ascii, display, entry } from "../common/numbers.js";
import { Range } from "./range.js";
import { explained } from "../common/words.js";

const TYPING = 400; // ms without a key after which what is typed counts

export class Field {
  /** change: function (symbol, text, event's time stamp) */
  constructor(spec, change) {
    this.spec = spec;
    this.change = change;
    this.element = this.build();
  }

  build() {
    const { symbol: name } = this.spec;
    const label = element("label", { className: "symbol", htmlFor: `entry-${name}` }, explained(name));
    const long = element("span", { className: "name", textContent: this.spec.name === name ? "" : this.spec.name });
    this.input = element("input", { type: "text", id: `entry-${name}`, spellcheck: false });
    this.slider = element("input", { id: `slider-${name}` });
    this.message = element("p", { className: "problem", id: `problem-${name}`, hidden: true });
    this.message.setAttribute("role", "alert");
    this.input.setAttribute("aria-describedby", `problem-${name}`);
    for (const control of [this.input, this.slider]) control.setAttribute("aria-label", `${this.spec.name} ${name}`);
    this.range = new Range(this.slider, this.spec);
    this.listen();
    return element("div", { className: "field explains" }, label, long, this.input, this.range.element, this.message);
  }

  listen() {
    let timer = 0;
    const typed = (event) => {
      clearTimeout(timer);
      if (ascii(this.input.value) !== this.text) this.tell(ascii(this.input.value), event.timeStamp);
    };
    this.input.addEventListener("input", (event) => {
      clearTimeout(timer);
      this.typing = true;
      timer = setTimeout(() => typed(event), TYPING);
    });
    this.input.addEventListener("change", (event) => {
      this.typing = false;
      if (this.completed !== this.text) this.text = null; // asked again, it is shown as the server writes it
      typed(event);
    });
    this.slider.addEventListener("input", (event) => {
      const text = entry(this.range.value, this.spec.unit);
      this.value = this.range.value;
      this.input.value = display(text);
      this.tell(text, event.timeStamp);
    });
    this.leaveToScrolling();
  }

  /** A finger that scrolls the page over the slider moves it a little before the browser knows: back then. */
  leaveToScrolling() {
    let before = null;
    this.slider.addEventListener("pointerdown", () => (before = { at: this.slider.value, text: this.text }));
    this.slider.addEventListener("pointercancel", (event) => {
      if (before === null || this.text === before.text) return;
      this.slider.value = before.at;
      this.input.value = display(before.text);
      this.tell(before.text, event.timeStamp);
    });
  }

  tell(text, stamp) {
    this.text = text;
    this.describe();
    this.change(this.spec.symbol, text, stamp);
  }

  /** Show a text that did not come from this field. */
  show(text) {
    this.text = text;
    this.input.value = display(text);
    this.describe();
  }

  /** Show what was typed as the server writes it, unless it is still being typed; the text. */
  complete(text = this.text) {
    this.completed = text;
    if (!this.typing) this.show(text);
    return this.text;
  }

  /** Put the slider where the server reads the value. */
  place(value) {
    this.value = value;
    this.range.place(value);
  }

  /** Mark the critical values: [[name, value in SI], ...]. */
  mark(critical) {
    this.range.mark(critical);
    this.describe();
  }

  /** Say what stands on the slider to those who do not see it. */
  describe() {
    this.range.describe(display(this.text), this.value);
  }

  /** Explain what is wrong, or no longer. */
  explain(problem) {
    this.message.hidden = !problem;
    this.message.textContent = problem ?? "";
    this.input.setAttribute("aria-invalid", problem ? "true" : "false");
  }
}
