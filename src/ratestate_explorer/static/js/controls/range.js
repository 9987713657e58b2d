// A slider over fixed decades, with its ends in numbers, and critical values marked at their places.

import { element } from "../common/dom.js";
import { shown } from "../common/numbers.js";
import { symbol } from "../common/words.js";

const STEP = 0.005; // decades: an arrow key changes a value by 1.2 %
const DECADES = { 1: 2 }; // from end to end, by unit
const USUAL_DECADES = 4;
// Shares of the slider: marks this close have one label, and one this near to an end is written inwards.
const CLOSE = 0.14;
const NEAR_END = 0.08;

export class Range {
  /** usual: a value, in SI, about which it reaches until it has one; marked: whether critical values may come */
  constructor(input, { unit, usual, marked }) {
    Object.assign(this, { input, unit, usual, sign: 1, isFixed: false, critical: [] });
    Object.assign(input, { type: "range", step: STEP });
    this.ends = [element("span"), element("span")];
    this.marks = element("div", { className: "marks", ariaHidden: "true", hidden: !marked });
    this.element = element("div", { className: "range" }, this.marks, input, element("div", { className: "ends", ariaHidden: "true" }, ...this.ends));
    this.reach(usual);
  }

  /** The value in SI at which the slider stands. */
  get value() {
    return this.sign * 10 ** Number(this.input.value);
  }

  /** Reach over whole decades about this value. */
  reach(value) {
    const decades = DECADES[this.unit] ?? USUAL_DECADES;
    const low = Math.round(Math.log10(Math.abs(value)) - decades / 2);
    this.input.min = low;
    this.input.max = low + decades;
    this.relabel();
  }

  /** Reach anew about the next value. */
  renew() {
    this.isFixed = false;
  }

  /** Stand at a value that was set elsewhere; without a logarithm, at an end. */
  place(value) {
    if (this.input.matches(":focus:active")) return; // under the hand
    this.sign = value < 0 ? -1 : 1;
    const at = Math.log10(Math.abs(value));
    if (!Number.isFinite(at)) {
      if (!this.isFixed) this.reach(this.usual);
      this.input.value = value > 0 ? this.input.max : this.input.min;
    } else {
      if (!this.isFixed || at < Number(this.input.min) || at > Number(this.input.max)) this.reach(value);
      this.input.value = at;
    }
    this.isFixed = true;
    this.relabel();
  }

  relabel() {
    const { min, max } = this.input;
    this.ends.forEach((end, i) => (end.textContent = shown(this.sign * 10 ** Number([min, max][i]), this.unit)));
    this.drawMarks();
  }

  /** Mark these values: [[name, value in SI], ...], in rising order. */
  mark(critical) {
    this.critical = critical;
    this.drawMarks();
  }

  drawMarks() {
    const [low, high] = [Number(this.input.min), Number(this.input.max)];
    const places = this.critical.map(([name, value]) => ({ name, share: (Math.log10(value) - low) / (high - low) }));
    const inside = this.sign > 0 ? places.filter(({ share }) => share >= 0 && share <= 1) : [];
    this.marks.replaceChildren(...inside.map(({ share }) => at(share, "tick")), ...labels(inside));
  }

  /** What is said of a text that stands for the slider's value: "960 MPa/m, below K_c". */
  describe(text, value) {
    const below = this.critical.filter((row) => row[1] <= value);
    const above = this.critical.filter((row) => row[1] > value);
    const sides = [below.length && `above ${below.at(-1)[0]}`, above.length && `below ${above[0][0]}`].filter(Boolean);
    this.input.setAttribute("aria-valuetext", [text, sides.join(" and ")].filter(Boolean).join(", "));
  }
}

/** One label for marks that are close together. */
function labels(places) {
  const groups = [];
  for (const place of places) {
    const last = groups.at(-1);
    if (last && place.share - last.at(-1).share < CLOSE) last.push(place);
    else groups.push([place]);
  }
  return groups.map((group) => {
    const share = (group[0].share + group.at(-1).share) / 2;
    const side = share < NEAR_END ? "after" : share > 1 - NEAR_END ? "before" : "about";
    const names = group.flatMap(({ name }, i) => [i ? " " : "", ...symbol(name)]);
    const label = at(share, `label ${side}`);
    label.append(...names);
    return label;
  });
}

/** An element at a share of the way that the thumb's middle takes. */
function at(share, className) {
  const node = element("span", { className });
  node.style.left = `calc(var(--thumb) / 2 + ${share} * (100% - var(--thumb)))`;
  return node;
}
