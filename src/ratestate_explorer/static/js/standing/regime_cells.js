// The regimes behind the map: cells of the atlas or of a finer part, up to K_c, and the strip beyond it.

import { REGIMES } from "./legend.js";
import { color } from "../common/theme.js";

const HATCH = 7; // px between the lines of the strip of coexistence

export class RegimeCells {
  /** answer: of "chart" or "window" */
  constructor(answer) {
    Object.assign(this, { ...answer, ...answer.arrays });
    this.paint();
  }

  /** One pixel a cell; again where colours change. */
  paint() {
    const { K_over_K_c_qs: x, eta: y, regime, regimes } = this;
    const roles = regimes.map((name) => REGIMES.find((of) => of.regime === name).role);
    const steady = regimes.indexOf("steady");
    this.image = new OffscreenCanvas(x.length, y.length);
    const c = this.image.getContext("2d");
    for (let i = 0; i < y.length; i += 1) {
      let last = steady;
      for (let k = 0; k < x.length; k += 1) {
        // Cycles end at K_c, amid cells: the last one's colour goes on, and `draw` cuts it there.
        const code = regime[i * x.length + k];
        if (code !== steady) last = code;
        c.fillStyle = color(roles[last]);
        c.fillRect(k, y.length - 1 - i, 1, 1);
      }
    }
  }

  /** Limits of the cells, which are centred on their points: [left, right, top, bottom] on the plane. */
  box(plane) {
    const { K_over_K_c_qs: x, eta: y } = this;
    const dx = (x.at(-1) / x[0]) ** (0.5 / (x.length - 1));
    const dy = (y.at(-1) / y[0]) ** (0.5 / (y.length - 1));
    return [plane.X(x[0] / dx), plane.X(x.at(-1) * dx), plane.Y(y.at(-1) * dy), plane.Y(y[0] / dy)];
  }

  /** line: K_c as [[ratio, eta], ...], beyond which sliding is steady */
  draw(plane, line) {
    const [left, right, top, bottom] = this.box(plane);
    plane.inside((c) => {
      c.imageSmoothingEnabled = false;
      c.fillStyle = color("steady");
      c.fillRect(left, top, right - left, bottom - top);
      c.beginPath();
      for (const [ratio, eta] of line) c.lineTo(plane.X(ratio), plane.Y(eta));
      c.lineTo(Math.min(left, plane.X(line[0][0])), plane.Y(line.at(-1)[1]));
      c.lineTo(Math.min(left, plane.X(line[0][0])), plane.Y(line[0][1]));
      c.clip();
      c.drawImage(this.image, left, top, right - left, bottom - top);
    });
  }

  /** The strip where cycles coexist with stable sliding: its points [K_c, K_fold, eta]; empty where none do. */
  get strip() {
    const { eta, K_c_over_K_c_qs: K_c, K_fold_over_K_c_qs: fold } = this;
    return Array.from(eta, (value, i) => [K_c[i], fold[i], value]).filter(([, last]) => !Number.isNaN(last));
  }

  /** Hatch that strip. */
  hatch(plane) {
    const { strip } = this;
    if (!strip.length) return;
    plane.inside((c) => {
      c.beginPath();
      for (const [K_c, , eta] of strip) c.lineTo(plane.X(K_c), plane.Y(eta));
      for (const [, fold, eta] of strip.toReversed()) c.lineTo(plane.X(fold), plane.Y(eta));
      c.closePath();
      c.clip();
      const { left, top, width, height } = plane.box;
      c.beginPath();
      for (let x = left - height; x < left + width; x += HATCH) {
        c.moveTo(x, top + height);
        c.lineTo(x + height, top);
      }
      c.strokeStyle = color("jump");
      c.lineWidth = 1.2;
      c.stroke();
    });
    plane.inside(() => plane.curve(strip.map(([, fold]) => fold), strip.map(([, , eta]) => eta), color("jump"), 1));
  }

  /** Its greatest width on the plane, in pixels. */
  stripWidth(plane) {
    return Math.max(0, ...this.strip.map(([K_c, fold]) => plane.X(fold) - plane.X(K_c)));
  }

  /** Whether there is a slider of this regime. */
  has(regime) {
    return this.regime.includes(this.regimes.indexOf(regime));
  }

  /** How far the cells reach beyond what the plane shows, to either side [px]. */
  excess(plane) {
    const { left, top, width, height } = plane.box;
    const [first, last, lowest, highest] = this.window;
    return [left - plane.X(first), plane.X(last) - left - width, top - plane.Y(highest), plane.Y(lowest) - top - height];
  }

  /** Whether there are cells of all that the plane shows. */
  covers(plane) {
    return this.excess(plane).every((px) => px > -1);
  }

  /** Whether they are those of what it shows, and no larger ones. */
  fills(plane) {
    return this.excess(plane).every((px) => Math.abs(px) < 1);
  }
}
