// The block, the spring that pulls it, the load point and the ground, at the instant.

import { fit } from "../common/canvas.js";
import { speedOf } from "../common/changes.js";
import { $ } from "../common/dom.js";
import { writeLabel } from "../common/labels.js";
import { plain, shown } from "../common/numbers.js";
import { placesAt, scaleOf } from "./places.js";
import { between, extremes, placeAt, section, valuesAt } from "../common/run.js";
import { FONT, color } from "../common/theme.js";
import { backward } from "../common/ticks.js";
import { number } from "../common/wire.js";
import { parts } from "../common/words.js";

const CAPTION = 24; // px under the ground
const BETWEEN = 12; // px from one caption to the next
const MARKS = { slant: 4, long: 8, short: 4, every: 5 }; // of the ground: px, and each fifth is long
const COILS = 9;
const TALLEST = 30; // px: the block, and the arrow of the normal stress

export class Machine {
  /** playback: Playback, whose pace the view follows */
  constructor(canvas, instant, playback) {
    Object.assign(this, { canvas, instant, playback, context: canvas.getContext("2d") });
    instant.on(() => this.draw());
    new ResizeObserver(() => this.picture && this.show(this.picture)).observe(canvas);
  }

  show(picture) {
    const { values, arrays } = picture;
    const { pace } = this.playback;
    const width = this.canvas.clientWidth;
    Object.assign(this, { picture, pace, rigid: number(values.K) === Infinity });
    if (pace) {
      this.scale = scaleOf(arrays, pace, width);
      this.speeds = extremes([section(arrays.run_V, arrays.run_time, pace.first, pace.last)]);
      this.largest = arrays.run_sigma ? Math.max(...arrays.run_sigma) : number(values.sigma);
    }
    this.draw();
  }

  draw() {
    const { canvas, context: c, pace, picture } = this;
    if (!picture) return;
    const [width, height] = fit(canvas, c, color("card"));
    if (!pace) return;
    const { arrays } = picture;
    const t = this.instant.time ?? pace.first;
    const places = placesAt(arrays, this.scale, t, width);
    const floor = height - CAPTION;
    const tall = Math.min(TALLEST, floor / 2);
    c.lineJoin = c.lineCap = "round";
    c.font = `11px ${FONT}`;
    this.ground(places.ground, floor, width);
    this.spring(places.block, places.loadPoint, floor - tall / 2, tall / 4);
    this.loadPoint(places.loadPoint, floor - tall / 2, tall / 2, speedOf(picture)(t) > 0);
    this.block(places.block, floor, tall, t);
  }

  /** Marks that pass, a line, and what they are. */
  ground(zero, floor, width) {
    const { context: c } = this;
    c.strokeStyle = color("text");
    c.lineWidth = 1.2;
    line(c, [0, floor], [width, floor]);
    if (!(this.scale.ground > 0)) return; // nothing moves at all
    const { apart, spring, ground } = this.scale;
    const step = apart * ground;
    c.strokeStyle = color("run");
    c.lineWidth = 1;
    for (let k = Math.ceil(-zero / step); zero + k * step <= width + MARKS.slant; k += 1) {
      const x = zero + k * step;
      line(c, [x, floor], [x - MARKS.slant, floor + (k % MARKS.every ? MARKS.short : MARKS.long)]);
    }
    c.fillStyle = color("muted");
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    const enlarged = spring / ground;
    const marks = `marks every ${shown(apart, "m", 2)}`;
    const [long, short] = ["spring's change", "spring"].map((what) => `${marks}; ${what} \u00d7 ${plain(enlarged, 2)}`);
    const room = width - c.measureText($("pace").textContent).width - BETWEEN;
    const caption = enlarged > 1.05 ? [long, short].find((text) => c.measureText(text).width < room) : marks;
    c.fillText(caption ?? marks, 0, floor + CAPTION - 3);
  }

  spring(from, to, y, reach) {
    const { context: c } = this;
    c.strokeStyle = color("text");
    c.lineWidth = this.rigid ? 3 : 1.4;
    c.beginPath();
    c.moveTo(from, y);
    if (!this.rigid) {
      const end = 7;
      const coil = (to - from - 2 * end) / COILS;
      c.lineTo(from + end, y);
      for (let k = 0; k < COILS; k += 1) {
        c.lineTo(from + end + (k + 0.25) * coil, y - reach);
        c.lineTo(from + end + (k + 0.75) * coil, y + reach);
      }
      c.lineTo(to - end, y);
    }
    c.lineTo(to, y);
    c.stroke();
  }

  /** A bar, and, unless it is held, the arrow of its motion. */
  loadPoint(x, y, reach, moves) {
    const { context: c } = this;
    c.strokeStyle = c.fillStyle = color("text");
    c.lineWidth = 3;
    line(c, [x, y - reach], [x, y + reach]);
    if (!moves) return;
    arrow(c, [x + 5, y], [x + 27, y]);
    writeLabel(c, parts("V_lp"), x + 18, y - 8);
  }

  /** The block, the more coloured the faster it slips, under the arrow of the normal stress. */
  block(right, floor, tall, t) {
    const { context: c, picture } = this;
    const { arrays, values } = picture;
    const wide = 1.5 * tall;
    const box = [right - wide, floor - tall, wide, tall];
    c.fillStyle = color("card");
    c.fillRect(...box);
    c.globalAlpha = shareOf(valuesAt(arrays, t).V, this.speeds);
    c.fillStyle = color("speed");
    c.fillRect(...box);
    c.globalAlpha = 1;
    c.strokeStyle = c.fillStyle = color("text");
    c.lineWidth = 1.6;
    c.strokeRect(...box);
    const sigma = arrays.run_sigma ? between(arrays.run_sigma, placeAt(arrays.run_time, t)) : number(values.sigma);
    const middle = right - wide / 2;
    const length = (floor - tall - 6) * (sigma / this.largest);
    if (length > 0) arrow(c, [middle, floor - tall - 3 - length], [middle, floor - tall - 3]);
    writeLabel(c, parts("sigma"), middle + 10, (floor - tall) / 2 + 2);
  }
}

/** Where a speed is between two others: by decades, or evenly where slip reverses. */
function shareOf(V, speeds) {
  const [slow, fast, now] = [...speeds, V].map(backward(speeds[0]) ? Number : Math.log);
  return fast > slow ? Math.min(1, Math.max(0, (now - slow) / (fast - slow))) : 0;
}

function line(c, from, to) {
  c.beginPath();
  c.moveTo(...from);
  c.lineTo(...to);
  c.stroke();
}

/** An arrow to the right or down. */
function arrow(c, [x, y], [toX, toY]) {
  c.lineWidth = 1.4;
  line(c, [x, y], [toX, toY]);
  const [back, aside] = toX > x ? [[-6, 0], [0, 3.2]] : [[0, -6], [3.2, 0]];
  c.beginPath();
  c.moveTo(toX, toY);
  for (const side of [1, -1]) c.lineTo(toX + back[0] + side * aside[0], toY + back[1] + side * aside[1]);
  c.fill();
}
