// A laboratory record behind the traces: its friction, and the speed of its load point.

import { element } from "../common/dom.js";
import { between, extremes, placeAt, within } from "../common/run.js";
import { color } from "../common/theme.js";

const WIDTH = 1;
const LONGEST_NAME = 24; // characters in the legend

/** A layer of the traces. */
export class LabRecord {
  /** changed: function (), called when another record is to be drawn, or elsewhere */
  constructor(changed) {
    Object.assign(this, { changed, arrays: null, name: "", zero: 0, whole: false });
  }

  /** Take a record as the server sends it; null for none. */
  set(found) {
    this.name = found?.name ?? "";
    this.arrays = found?.arrays ?? null;
    this.zero = found?.begin ?? 0; // the record's time [s] that lies at time 0 of the run
    this.speed = found && speedOf(found.arrays);
    this.changed();
  }

  /** Lay another of the record's times [s] at time 0 of the run. */
  shift(zero) {
    this.zero = zero;
    this.changed();
  }

  /** Show all times of the record, or only those of the run. */
  showWhole(whole) {
    this.whole = whole;
    this.changed();
  }

  // ---- as a layer

  draw({ ctx, scales }, name, X, Y) {
    if (!this.arrays) return;
    const isLog = scales.y.distr === 3;
    ctx.lineWidth = WIDTH * devicePixelRatio;
    ctx.lineJoin = "round";
    ctx.strokeStyle = color("record");
    const { time, values } = this.curve(name);
    const line = (values) => {
      ctx.beginPath();
      let goesOn = false;
      for (let i = 0; i < time.length; i += 1) {
        // A load point that rests has no place on a logarithmic axis.
        const is = !(name === "speed" && isLog) || values[i] > 0;
        if (is) ctx[goesOn ? "lineTo" : "moveTo"](X(time[i] - this.zero), Y(values[i]));
        goesOn = is;
      }
      ctx.stroke();
    };
    line(values);
    const fit = this.arrays.friction_fit;
    if (!fit || name === "speed") return;
    ctx.strokeStyle = color("fit");
    ctx.lineWidth *= 2;
    line(fit);
  }

  /** Of speeds, the range of those that slide. */
  range(name, from, to) {
    if (!this.arrays) return extremes([]);
    const { time, values } = this.curve(name);
    const [first, last] = [from + this.zero, to + this.zero];
    if (time[0] > last || time.at(-1) < first) return extremes([]);
    const visible = within(time, values, first, last);
    return extremes([name === "speed" ? visible.filter((V) => V > 0) : visible]);
  }

  times() {
    if (!this.arrays || !this.whole) return [];
    const { time } = this.arrays;
    return [time[0] - this.zero, time.at(-1) - this.zero];
  }

  key(time) {
    if (!this.arrays) return null;
    const long = this.name.length > LONGEST_NAME;
    const short = long ? `${this.name.slice(0, LONGEST_NAME - 1)}\u2026` : this.name;
    const value = time === null ? null : this.frictionAt(time);
    const text = value === null ? short : value.toPrecision(4); // one line must hold all values
    const fit = this.arrays.friction_fit ? [element("span", { className: "line fit" }), "fit"] : [];
    return element("span", { title: this.name }, element("span", { className: "line record" }), text, ...fit);
  }

  // ---- what there is

  curve(name) {
    if (name === "speed") return this.speed;
    return { time: this.arrays.time, values: this.arrays.friction };
  }

  /** Recorded friction at a time of the run [s]; null where nothing was recorded. */
  frictionAt(t) {
    const { time, friction } = this.arrays;
    const at = t + this.zero;
    if (at < time[0] || at > time.at(-1)) return null;
    return between(friction, placeAt(time, at));
  }
}

/** The load point's speed in time: as recorded, else that of the segments, as a staircase. */
function speedOf({ time, V_load: recorded, segment_t: starts, segment_V: speeds }) {
  if (recorded) return { time, values: recorded };
  const ends = [...starts.slice(1), time.at(-1)];
  return {
    time: Float64Array.from([...starts].flatMap((start, i) => [start, ends[i]])),
    values: Float64Array.from([...speeds].flatMap((V) => [V, V])),
  };
}
