// How fast a run is played: equal times for equal lengths of its curve, so that each slip takes its time.

import { plain } from "../common/numbers.js";
import { between, extremes, placeAt, section } from "../common/run.js";
import { backward } from "../common/ticks.js";

const RATE = 2; // length of the curve played in a second, where the run is as long as 1 in each direction
const SHORTEST = 6; // s of playing
const NARROWEST = { stress: 1e-9, V: 1e-6 }; // ranges of tau/sigma and log V: what is less is rounding
const JUMP = 1e-15; // of the times: closer points are before and after a jump, which takes no time
const NEARBY = 0.1; // s of playing, before and after: the pace is told as their mean
const SAME = 0.05; // about real time

export class Pace {
  /** arrays: of a run, two points or more; [first, last]: the times of it that are played [s] */
  constructor({ run_time: time, run_stress: stress, run_V: V }, [first, last]) {
    Object.assign(this, { time, first: Math.max(first, time[0]), last: Math.min(last, time.at(-1)) });
    const speeds = backward(extremes([V])[0]) ? V : V.map(Math.log);
    const reach = (values) => extremes([section(values, time, this.first, this.last)]);
    const [low, high] = reach(stress);
    const [slow, fast] = reach(speeds);
    const wide = Math.max(high - low, NARROWEST.stress);
    const tall = Math.max(fast - slow, NARROWEST.V);
    const long = this.last - this.first;
    const atOnce = JUMP * Math.max(Math.abs(time[0]), Math.abs(time.at(-1)));
    this.lengths = new Float64Array(time.length);
    for (let i = 1; i < time.length; i += 1) {
      const passed = time[i] - time[i - 1];
      const piece = Math.hypot(passed / long, (stress[i] - stress[i - 1]) / wide, (speeds[i] - speeds[i - 1]) / tall);
      this.lengths[i] = this.lengths[i - 1] + (passed > atOnce ? piece : 0);
    }
    this.start = between(this.lengths, placeAt(time, this.first));
    this.length = between(this.lengths, placeAt(time, this.last)) - this.start;
    this.duration = Math.max(this.length / RATE, SHORTEST); // s of playing, at speed 1
  }

  /** The time of the run [s] at a share of the playing time. */
  timeAt(share) {
    return between(this.time, placeAt(this.lengths, this.start + share * this.length));
  }

  /** The share of the playing time at a time of the run [s]; below 0 or above 1 if that is not played. */
  shareAt(time) {
    return (between(this.lengths, placeAt(this.time, time)) - this.start) / this.length;
  }

  /** Seconds of the run in one of playing, about a share of the playing time. */
  factorAt(share) {
    const near = NEARBY / this.duration;
    const [before, after] = [Math.max(share - near, 0), Math.min(share + near, 1)];
    return (this.timeAt(after) - this.timeAt(before)) / ((after - before) * this.duration);
  }
}

/** Seconds of the run in one of playing, in words. */
export function paceText(factor) {
  if (Math.abs(factor - 1) < SAME) return "real time";
  return factor < 1 ? `slowed ${plain(1 / factor, 2)} times` : `${plain(factor, 2)} times faster`;
}
