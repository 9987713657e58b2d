// Where block, load point and ground of a run are drawn, in a view that follows the load point.

import { between, extremes, placeAt, section } from "../common/run.js";
import { roundUp } from "../common/ticks.js";

const LOAD_AT = { least: 52, share: 0.12 }; // px from the right end, and as a share of the width
const TRAVEL = 0.42; // of the width: how far the block moves in the view
const SHORTEST = 0.16; // of the width: the spring where it is shortest
const SMALLEST = 1e-9; // of the load point's way: what changes of the spring are not rounding
const MARKS = { least: 36, share: 0.05 }; // px between marks of the ground at least, also as a share of the width
const PASSING = 22; // marks in a second at most: others are not followed by the eye
const SAMPLES = 400; // of the run, to know how fast that is

/**
 * How a run is drawn in a view so many px wide: `shortest`, the spring's change where it is shortest
 * [m]; px per m of that change, `spring`, and of the ground, `ground`: the same, unless the ground
 * would pass too fast; and metres from mark to mark, `apart`.
 */
export function scaleOf({ run_time: time, run_slip: slip, run_load: load }, pace, width) {
  const changes = load.map((way, i) => way - slip[i]);
  const [shortest, longest] = extremes([section(changes, time, pace.first, pace.last)]);
  const ways = Array.from({ length: SAMPLES + 1 }, (_, k) => between(load, placeAt(time, pace.timeAt(k / SAMPLES))));
  const passing = (Math.max(...ways.slice(1).map((way, k) => way - ways[k])) * SAMPLES) / pace.duration;
  const changing = longest - shortest > SMALLEST * (ways.at(-1) - ways[0]);
  const spring = changing ? (TRAVEL * width) / (longest - shortest) : 0;
  const marks = Math.max(MARKS.least, MARKS.share * width);
  const most = passing > 0 ? (PASSING * marks) / passing : spring;
  const ground = changing ? Math.min(spring, most) : most;
  return { shortest, spring, ground, apart: roundUp(marks / ground) };
}

/** Places at a time of the run [s], in px from the left: the block's right end, the load point, and mark 0 of the ground. */
export function placesAt({ run_time: time, run_slip: slip, run_load: load }, scale, t, width) {
  const place = placeAt(time, t);
  const [way, slipped] = [between(load, place), between(slip, place)];
  const loadPoint = width - Math.max(LOAD_AT.least, LOAD_AT.share * width);
  const spring = SHORTEST * width + scale.spring * (way - slipped - scale.shortest);
  return { block: loadPoint - spring, loadPoint, ground: loadPoint - scale.ground * way };
}
