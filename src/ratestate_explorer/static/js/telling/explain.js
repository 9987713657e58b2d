// What a symbol or term means, beside it: where it is pointed at, reached by keyboard, or tapped.
// As WCAG 1.4.13 has it: Escape sends it away, the pointer may go onto it, and it stays meanwhile.

import { element } from "../common/dom.js";
import { display } from "../common/numbers.js";
import { symbol, write } from "../common/words.js";

const REST = 250; // ms for which the pointer must rest on a symbol
const LINGER = 250; // ms in which the pointer may go from a symbol onto its explanation
const GAP = 6; // px
const MARGIN = 8; // px to the edge of the window

export class Explanations {
  /**
   * tip: element with role "tooltip"
   * Elements with data-meaning are explained, and focused controls by the first such in their .explains.
   */
  constructor(tip) {
    Object.assign(this, { tip, meanings: {}, timer: 0, of: null, control: null, dismissed: null, pointer: "" });
    this.listenToPointer();
    this.listenToKeys();
    for (const moved of ["scroll", "resize"]) addEventListener(moved, () => this.follow(), { capture: true, passive: true });
  }

  /** meanings: symbol or term -> {name, unit, text} */
  learn(meanings) {
    this.meanings = meanings;
  }

  listenToPointer() {
    document.addEventListener("pointerover", (event) => event.pointerType !== "touch" && this.over(event.target));
    document.documentElement.addEventListener("pointerleave", () => this.over(document.body));
    document.addEventListener("pointerdown", (event) => (this.pointer = event.pointerType), true);
    document.addEventListener("click", (event) => this.pointer === "touch" && this.tap(event));
  }

  listenToKeys() {
    document.addEventListener("keydown", (event) => {
      this.pointer = "";
      if (event.key === "Escape") this.dismiss();
    }, true);
    document.addEventListener("focusin", ({ target }) => {
      const named = this.pointer ? null : (target.closest("[data-meaning]") ?? target.closest(".explains")?.querySelector("[data-meaning]"));
      if (named) this.show(named, target);
      else if (this.control) this.hide();
    });
    document.addEventListener("focusout", () => this.control && this.hide());
    // What is being changed is to be seen.
    document.addEventListener("input", () => this.hide());
  }

  over(target) {
    const named = target.closest("[data-meaning]");
    if (named !== this.dismissed) this.dismissed = null;
    else if (named) return;
    if (this.tip.contains(target) || (named && named === this.of)) clearTimeout(this.timer);
    else if (named) this.later(() => this.show(named), REST);
    else if (!this.control) this.later(() => this.hide(), LINGER);
  }

  /** Hide it until the pointer or the focus is elsewhere. */
  dismiss() {
    this.dismissed = this.of;
    this.hide();
  }

  later(act, wait) {
    clearTimeout(this.timer);
    this.timer = setTimeout(act, wait);
  }

  tap(event) {
    const named = event.target.closest("[data-meaning]");
    if (this.tip.contains(event.target)) return;
    if (!named || named === this.of) {
      this.hide();
      return;
    }
    // A symbol that labels an entry would open the keyboard.
    if (named.closest("label")?.control?.type === "text") event.preventDefault();
    this.show(named);
  }

  /** Explain what an element names; control: what has the focus, if that is why. */
  show(named, control = null) {
    const known = named.dataset.meaning.split(",").filter((name) => name in this.meanings);
    this.hide();
    if (!known.length || !named.isConnected) return;
    Object.assign(this, { of: named, control });
    this.tip.replaceChildren(...known.flatMap((name) => this.written(name)));
    this.tip.hidden = false;
    this.place();
    describe(control ?? named, this.tip.id, true);
  }

  written(name) {
    const { name: long, unit, text } = this.meanings[name];
    const isWords = long === name || name.includes(" ");
    const names = isWords ? [] : [element("b", {}, ...symbol(name)), " "];
    const head = element("p", { className: "meaning" }, ...names, long, unit === "1" ? "" : ` [${display(unit)}]`);
    const body = element("p");
    write(body, text);
    return [head, body];
  }

  /** Above what it explains, or else below, inside the window. */
  place() {
    const { left, top, bottom } = (this.control?.closest(".explains") ?? this.of).getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = this.tip;
    const above = top - GAP - height;
    this.tip.style.left = `${Math.max(MARGIN, Math.min(left, document.documentElement.clientWidth - width - MARGIN))}px`;
    this.tip.style.top = `${above >= MARGIN ? above : Math.min(bottom + GAP, innerHeight - height - MARGIN)}px`;
  }

  /** The page was moved under the pointer; or perhaps by the focus, which is still there. */
  follow() {
    if (this.control) this.place();
    else this.hide();
  }

  hide() {
    clearTimeout(this.timer);
    if (!this.of) return;
    describe(this.control ?? this.of, this.tip.id, false);
    Object.assign(this, { of: null, control: null });
    this.tip.hidden = true;
  }
}

/** Add an id to what describes an element, or take it away. */
function describe(node, id, wanted) {
  const others = (node.getAttribute("aria-describedby") ?? "").split(" ").filter((other) => other && other !== id);
  const all = wanted ? [...others, id] : others;
  if (all.length) node.setAttribute("aria-describedby", all.join(" "));
  else node.removeAttribute("aria-describedby");
}
