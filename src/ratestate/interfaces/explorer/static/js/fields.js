// The parameters: an entry with a unit, and a slider over the decades about it.

import { element } from "./dom.js";
import { ascii, display, entry, isBare, withUnit } from "./numbers.js";
import { symbol } from "./words.js";

const STEP = 0.005; // decades: an arrow key changes a value by 1.2 %
const SPAN = { 1: 1 }; // decades to either side, by unit
const USUAL_SPAN = 2;
const EDGE = 0.15; // of the slider: where it is left there, it moves on
const TYPING = 400; // ms without a key after which what is typed counts

export class Field {
  /** change: function (symbol, text, event's time stamp) */
  constructor(spec, change) {
    this.spec = spec;
    this.change = change;
    this.sign = 1; // of the value: the slider sets its size
    this.element = this.build();
  }

  build() {
    const { symbol: name } = this.spec;
    const label = element("label", { className: "symbol", htmlFor: `entry-${name}` }, ...symbol(name));
    const long = element("span", { className: "name", textContent: this.spec.name === name ? "" : this.spec.name });
    this.input = element("input", { type: "text", id: `entry-${name}`, spellcheck: false });
    this.slider = element("input", { type: "range", id: `slider-${name}`, step: STEP });
    this.message = element("p", { className: "problem", id: `problem-${name}`, hidden: true });
    this.message.setAttribute("role", "alert");
    this.input.setAttribute("aria-describedby", `problem-${name}`);
    for (const control of [this.input, this.slider]) control.setAttribute("aria-label", `${this.spec.name} ${name}`);
    this.reach(Math.log10(this.spec.usual));
    this.listen();
    return element("div", { className: "field" }, label, long, this.input, this.slider, this.message);
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
      if (this.isBare) this.text = null; // asked again, it is given its unit
      typed(event);
    });
    this.slider.addEventListener("input", (event) => {
      const text = entry(this.sign * 10 ** Number(this.slider.value), this.spec.unit);
      this.input.value = display(text);
      this.tell(text, event.timeStamp);
    });
    this.slider.addEventListener("change", () => this.recentre(Number(this.slider.value)));
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
    this.slider.setAttribute("aria-valuetext", display(text));
    this.change(this.spec.symbol, text, stamp);
  }

  /** Show a text that did not come from this field. */
  show(text) {
    this.text = text;
    this.input.value = display(text);
    this.slider.setAttribute("aria-valuetext", display(text));
  }

  /** Whether what is shown lacks its unit: a number in SI. */
  get isBare() {
    return isBare(this.input.value, this.spec.unit);
  }

  /** Show what was typed as all texts are, a number in SI with its unit, unless it is still being typed; the text. */
  complete() {
    if (!this.typing) this.show(this.isBare ? withUnit(this.input.value, this.spec.unit) : this.text);
    return this.text;
  }

  /** Put the slider where the server reads the value. */
  place(value) {
    this.value = value;
    if (document.activeElement === this.slider && this.slider.matches(":active")) return;
    this.sign = value < 0 ? -1 : 1;
    const at = Math.log10(Math.abs(value));
    if (!Number.isFinite(at)) {
      this.slider.value = value > 0 ? this.slider.max : this.slider.min;
    } else {
      this.recentre(at);
      this.slider.value = at;
    }
  }

  /** Let the slider reach further where the value is near its end. */
  recentre(at) {
    const [low, high] = [Number(this.slider.min), Number(this.slider.max)];
    if (at > low + EDGE * (high - low) && at < high - EDGE * (high - low)) return;
    this.reach(at);
  }

  /** Let the slider reach about this power of ten. */
  reach(at) {
    const span = SPAN[this.spec.unit] ?? USUAL_SPAN;
    const middle = Math.round(2 * at) / 2;
    this.slider.min = middle - span;
    this.slider.max = middle + span;
    this.slider.value = at;
  }

  /** Explain what is wrong, or no longer. */
  explain(problem) {
    this.message.hidden = !problem;
    this.message.textContent = problem ?? "";
    this.input.setAttribute("aria-invalid", problem ? "true" : "false");
  }
}
