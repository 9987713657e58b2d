// Runs that are kept on the charts, to compare others with.

import { $, element } from "../common/dom.js";
import { display } from "../common/numbers.js";
import { extremes, within } from "../common/run.js";
import { color } from "../common/theme.js";
import { symbol } from "../common/words.js";

const ROLES = ["pinned-1", "pinned-2", "pinned-3"]; // colours; one run has each
const MOST_NAMED = 3; // of the differences
const BEFORE = ["V_from", "sigma_from"]; // entries of what was before time 0

/** What an entry of a run is, as nodes: a value, one before time 0, or that there is none. */
function difference(name, text) {
  const said = [...symbol(name), BEFORE.includes(name) ? " before" : ""];
  return text === undefined ? ["no ", ...said] : [...said, ` = ${display(text)}`];
}

export class Pins {
  /** changed: function (), called when there is one more or less */
  constructor(changed) {
    Object.assign(this, { changed, all: [], shown: {} });
    $("pin").addEventListener("click", () => this.add(this.picture, this.shown));
    this.tell();
  }

  /** What is shown now: the picture, and the texts behind it. */
  show(picture, texts) {
    Object.assign(this, { picture, shown: texts });
    this.tell();
  }

  /** The texts of each. */
  get texts() {
    return this.all.map(({ texts }) => texts);
  }

  add(picture, texts) {
    const role = ROLES.find((free) => this.all.every((pin) => pin.role !== free));
    if (!role || !picture) return;
    const pin = { role, picture, texts, words: element("span") };
    this.all.push(pin);
    $("pins").append(this.item(pin));
    this.tell();
    this.changed();
  }

  remove(pin) {
    this.all = this.all.filter((other) => other !== pin);
    pin.words.parentElement.remove();
    this.tell();
    this.changed();
    $("pin").focus();
  }

  /** The legend: how each differs from what is shown. */
  tell() {
    $("pin").disabled = !this.picture || this.all.length === ROLES.length;
    for (const pin of this.all) pin.words.replaceChildren(...this.differences(pin));
  }

  item(pin) {
    const off = element("button", { type: "button", className: "quiet", textContent: "\u00d7" });
    pin.words.id = `words-of-${pin.role}`;
    off.setAttribute("aria-label", "Remove this run");
    off.setAttribute("aria-describedby", pin.words.id);
    off.addEventListener("click", () => this.remove(pin));
    const line = element("span", { className: "line" });
    line.style.borderColor = `var(--${pin.role})`;
    return element("li", {}, line, pin.words, off);
  }

  differences({ texts }) {
    const names = Object.keys({ ...this.shown, ...texts }).filter((name) => texts[name] !== this.shown[name]);
    const told = names.slice(0, MOST_NAMED).flatMap((name, i) => [i ? ", " : "", ...difference(name, texts[name])]);
    return names.length ? [...told, names.length > MOST_NAMED ? ", \u2026" : ""] : ["the run shown"];
  }

  // ---- a layer of the traces

  draw({ ctx }, name, X, Y) {
    for (const { role, picture } of this.all) {
      const [time, values] = curve(picture, name);
      ctx.beginPath();
      for (let i = 0; i < time.length; i += 1) ctx.lineTo(X(time[i]), Y(values[i]));
      ctx.strokeStyle = color(role);
      ctx.lineWidth = 1.2 * devicePixelRatio;
      ctx.stroke();
    }
  }

  range(name, first, last) {
    return extremes(this.all.map(({ picture }) => within(...curve(picture, name), first, last)));
  }

  times() {
    return this.all.flatMap(({ picture }) => [...picture.arrays.run_time.subarray(0, 1), ...picture.arrays.run_time.subarray(-1)]);
  }
}

function curve({ arrays }, name) {
  return [arrays.run_time, name === "stress" ? arrays.run_stress : arrays.run_V];
}
