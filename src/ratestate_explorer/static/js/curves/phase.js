// The phase plane: V against tau/sigma, on a logarithmic axis, or a linear one where slip reverses.

import { nearest } from "./nearest.js";
import { Plane } from "../common/plane.js";
import { between, extremes, pieceAt, placeOf, valuesAt } from "../common/run.js";
import { color } from "../common/theme.js";
import { backward, counted, speeds } from "../common/ticks.js";
import { number } from "../common/wire.js";
import { parts } from "../common/words.js";

const PADDING = 0.07;
const SMALLEST = 1e-12; // of tau/sigma: room about a point
const NEAR = 24; // px: a curve is pointed at from so far
const SAME = 3; // px: of curves so close, the run is meant, and its last passage

export class Phase {
  /** point: element that marks the instant; cycleKey: the legend's entry of the limit cycle; whole: checkbox; pins: Pins */
  constructor(canvas, point, cycleKey, whole, instant, pins) {
    Object.assign(this, { canvas, point, cycleKey, whole, instant, pins });
    this.plane = new Plane(canvas, { log: false }, { log: true });
    this.plane.explain("tau/sigma", "V");
    instant.on(() => this.mark());
    whole.addEventListener("change", () => this.draw());
    for (const kind of ["pointermove", "pointerdown"]) canvas.addEventListener(kind, (event) => this.pointAt(event));
    // (a finger that is lifted leaves too, and what it pointed at stays)
    canvas.addEventListener("pointerleave", ({ pointerType }) => pointerType === "mouse" && instant.point(null));
  }

  show(picture) {
    this.picture = picture;
    this.cycleKey.style.visibility = picture.arrays.cycle_V ? "visible" : "hidden";
    this.draw();
  }

  draw() {
    if (!this.picture) return;
    const { arrays, steady, values } = this.picture;
    const { plane } = this;
    this.range();
    plane.begin();
    plane.frame();
    plane.inside((c) => {
      plane.curve(arrays.run_stress, arrays.run_V, color("run"), 0.8);
      for (const pin of this.pins.all) plane.curve(...this.curve(pin.picture.arrays), color(pin.role), 1.4);
      if (arrays.cycle_V) plane.curve(arrays.cycle_stress, arrays.cycle_V, color("cycle"), 2);
      c.beginPath();
      c.arc(plane.X(steady), plane.Y(values.V_lp), 4.5, 0, 2 * Math.PI);
      c.fillStyle = color("card");
      c.fill();
      c.strokeStyle = color("text");
      c.lineWidth = 1.6;
      c.stroke();
    });
    this.mark();
  }

  /** Put the point where the run is at the instant. */
  mark() {
    const { time } = this.instant;
    const at = time !== null && this.picture ? valuesAt(this.picture.arrays, time) : null;
    const [x, y] = at ? [this.plane.X(at.stress), this.plane.Y(at.V)] : [];
    this.point.hidden = !at || !this.plane.isInside(x, y);
    if (this.point.hidden) return;
    this.point.style.transform = `translate(${x}px, ${y}px)`;
  }

  pointAt({ clientX, clientY }) {
    if (!this.picture) return;
    const { left, top } = this.canvas.getBoundingClientRect();
    const at = [clientX - left, clientY - top];
    this.instant.point(this.plane.isInside(...at) ? this.timeAt(...at) : null);
  }

  /**
   * When the run is nearest to a point of the canvas [s]; null if neither it nor the cycle is near.
   * Near the cycle alone it is when the run's last period is nearest to that point of it.
   */
  timeAt(px, py) {
    const { arrays, numbers } = this.picture;
    const times = arrays.run_time;
    const run = this.pixels(arrays.run_stress, arrays.run_V);
    const cycle = arrays.cycle_V ? this.pixels(arrays.cycle_stress, arrays.cycle_V) : [[], []];
    const [onRun, onCycle] = [run, cycle].map((curve) => nearest(...curve, px, py, SAME));
    if (Math.min(onRun.distance, onCycle.distance) > NEAR) return null;
    if (onRun.distance <= onCycle.distance + SAME) return between(times, placeOf(onRun.at, times.length));
    const [x, y] = cycle.map((values) => between(values, placeOf(onCycle.at, values.length)));
    const from = pieceAt(times, times.at(-1) - number(numbers.period));
    const late = nearest(...run.map((values) => values.subarray(from)), x, y);
    return times.length > 1 ? between(times, placeOf(from + late.at, times.length)) : null;
  }

  /** A curve in px of the canvas. */
  pixels(stress, V) {
    return [stress.map((value) => this.plane.X(value)), V.map((value) => this.plane.Y(value))];
  }

  /** Stress and V of the cycle; without one, or if asked to, of the whole run. */
  curve(arrays) {
    const isRun = !arrays.cycle_V || this.whole.checked;
    return isRun ? [arrays.run_stress, arrays.run_V] : [arrays.cycle_stress, arrays.cycle_V];
  }

  range() {
    const { arrays, steady, values } = this.picture;
    const all = [arrays, ...this.pins.all.map((pin) => pin.picture.arrays)];
    const shown = [[[steady], [values.V_lp]], ...all.map((each) => this.curve(each))];
    const [low, high] = extremes(shown.map(([stress]) => stress));
    const pad = Math.max(PADDING * (high - low), SMALLEST);
    const across = { low: low - pad, high: high + pad };
    const stresses = (wanted) => counted(across.low, across.high, wanted);
    const label = [["i", "\u03c4"], ["", " / "], ["i", "\u03c3"], ["", stresses(5)[1]]];
    Object.assign(this.plane.x, across, { ticks: (wanted) => stresses(wanted)[0], label });
    const ends = extremes(shown.map(([, V]) => V));
    const log = !backward(ends[0]);
    const [slow, fast] = log ? ends.map(Math.log) : ends;
    const room = Math.max(PADDING * (fast - slow), 1e-6);
    const range = log ? { log, low: Math.exp(Math.max(slow - room, -700)), high: Math.exp(fast + room) } : { log, low: slow - room, high: fast + room };
    const [, unit] = speeds(range.low, range.high, 5);
    const ticks = (wanted) => speeds(range.low, range.high, wanted)[0];
    Object.assign(this.plane.y, range, { ticks, label: ["V", unit].flatMap(parts) });
  }
}
