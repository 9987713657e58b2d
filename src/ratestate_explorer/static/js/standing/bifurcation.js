// The bifurcation diagram on the page: what decides it, and the slider on it as a dot, which sets the parameter.

import { Diagram, NAMES } from "./diagram.js";
import { drawDot, placed } from "../common/dot.js";
import { Handle } from "../common/handle.js";
import { shown } from "../common/numbers.js";
import { number } from "../common/wire.js";

const ARROW = 0.02; // decades

export class Bifurcation {
  /**
   * page: elements {canvas, dot, note, along, measure}
   * on: {set(parameter, value, event's time stamp), called while the dot moves; chosen(), once another
   * parameter is; whenRead(act), as for the map}
   *
   * target is where the dot was sent before it is drawn there; the page clears it.
   */
  constructor(page, { set, chosen, whenRead }) {
    Object.assign(this, { page, set, units: {}, found: null, isOld: false, target: null, key: "", reach: "" });
    this.diagram = new Diagram(page.canvas);
    this.plane = this.diagram.plane;
    this.whenRead = (act) => (this.target ? act() : whenRead(act));
    page.along.addEventListener("change", chosen);
    page.measure.addEventListener("change", () => this.draw());
    this.handle = new Handle(page.canvas, page.dot, {
      isUsable: () => this.found && this.picture,
      drag: (x, y, stamp) => {
        const [value] = this.plane.values(x, y);
        this.whenRead(() => this.send(value, stamp));
      },
      step: (way, stamp) => this.whenRead(() => this.step(way, stamp)),
    });
  }

  /** fields: all that decides the diagram, beside law and form of friction, with their units */
  open(fields) {
    this.units = Object.fromEntries(fields.map(({ symbol, unit }) => [symbol, unit]));
  }

  get along() {
    return this.page.along.value;
  }

  /** What decides the diagram, as text: all but the parameter itself, unless the slider leaves the range shown. */
  decisive() {
    const { along, found, picture: { values } } = this;
    const key = JSON.stringify([along, ...[...Object.keys(this.units), "law", "friction_form"].filter((name) => name !== along).map((name) => values[name])]);
    const value = number(values[along]);
    if (key !== this.key) Object.assign(this, { key, reach: "" });
    else if (!this.isOld && found?.along === along && value > 0 && Number.isFinite(value) && (value < found.low || value > found.high)) {
      this.reach = String(Math.round(2 * Math.log10(value)));
    }
    return `${key} ${this.reach}`;
  }

  /** The diagram on the page is no longer that of the slider. */
  age() {
    this.isOld = true;
    this.tell(this.found ? "" : "Computing the limit cycles \u2026");
    this.draw();
  }

  /** The server's diagram. */
  take(found) {
    Object.assign(this, { found, isOld: false });
    this.tell(found.note);
    this.draw();
  }

  tell(text) {
    this.page.note.textContent = text;
    this.page.note.hidden = !text;
  }

  show(picture) {
    this.picture = picture;
    this.draw();
  }

  draw() {
    const { plane, found, picture, page } = this;
    if (!page.canvas.clientWidth) return; // behind the other tab
    plane.begin();
    this.handle.dot.hidden = !found || !picture;
    if (this.handle.dot.hidden) return;
    this.diagram.draw({ found, units: this.units, V_lp: picture.values.V_lp, measure: page.measure.value, isOld: this.isOld });
    this.put();
    this.describe();
  }

  put() {
    const { plane, found, diagram, picture: { numbers, values } } = this;
    const value = number(values[found.along]);
    const isKnown = numbers[diagram.measure] !== null;
    const own = isKnown ? number(numbers[diagram.measure]) : diagram.steadyAt(value);
    const { px, py, isBeyond } = placed(plane, value, own);
    drawDot(plane.context, px, py, isBeyond || !isKnown);
    this.handle.put(px, py);
    const size = diagram.ofSpeed ? `V_max ${shown(own, "m/s", 3)}` : `amplitude ${own.toPrecision(3)}`;
    const what = isKnown ? size : "its motion is not known";
    const beyond = isBeyond ? ", beyond the diagram" : "";
    this.handle.dot.setAttribute("aria-label", `The slider on the bifurcation diagram: ${this.named(value)}, ${what}${beyond}; arrow keys move it`);
  }

  named(value) {
    return `${this.found.along} = ${shown(value, this.units[this.found.along])}`;
  }

  describe() {
    const { diagram, found } = this;
    const points = diagram.marks().map(([kind, x]) => `${NAMES[kind]} at ${this.named(x)}`);
    const what = diagram.ofSpeed ? "V_max" : "Amplitude of tau/sigma";
    this.page.canvas.setAttribute("aria-label", `${what} of limit cycles against ${found.along}. ${points.join("; ") || "No bifurcation point"}.`);
  }

  step([right, up], stamp) {
    const { low, high } = this.found;
    const value = this.target ?? number(this.picture.values[this.found.along]);
    // M = 0 and K = inf are on no logarithmic axis: from the end of this one
    const from = value === 0 ? low : value === Infinity ? high : value;
    this.send(from * 10 ** (ARROW * (right + up)), stamp);
  }

  send(value, stamp) {
    this.set(this.found.along, value, stamp);
    this.target = value;
  }
}
