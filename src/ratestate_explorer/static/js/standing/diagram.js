// Limit cycles and steady sliding along a parameter, drawn: solid where they are stable, dashed where not.

import { display } from "../common/numbers.js";
import { Plane } from "../common/plane.js";
import { FONT, color } from "../common/theme.js";
import { linear, zoomed } from "../common/ticks.js";
import { parts } from "../common/words.js";

const DASH = [5, 4];
const ROOM = 0.06; // above and below what is drawn, over its height
const LEAST = 1e-3; // amplitude up to which the axis reaches where there are no cycles
const BESIDE = 8; // points of a branch to either side of a named one, which tell where there is room
/** kinds of points -> what is written beside them */
export const NAMES = { hopf: "Hopf", fold: "fold", period_doubling: "period doubling", torus: "torus" };

export class Diagram {
  constructor(canvas) {
    this.plane = new Plane(canvas, { log: true }, {});
    this.plane.x.ticks = (wanted) => zoomed(this.plane.x.low, this.plane.x.high, wanted);
  }

  /** Whether it shows speeds, and not amplitudes. */
  get ofSpeed() {
    return this.measure === "V_max";
  }

  /**
   * what: {found: the server's answer, units of the parameters, V_lp of the slider,
   * measure: "amplitude" or "V_max", isOld: whether it is no longer that of the slider}
   */
  draw(what) {
    Object.assign(this, what);
    this.fit();
    this.plane.frame();
    this.plane.inside((c) => {
      this.drawSteady(c);
      this.drawCycles(c);
      c.setLineDash([]);
    });
    for (const mark of this.marks()) this.drawMark(mark);
  }

  /** Axes about all that is drawn. */
  fit() {
    const { plane, found, ofSpeed } = this;
    const { low, high, along } = found;
    Object.assign(plane.x, { low, high, label: [...parts(along), ["", `  [${display(this.units[along])}]`]] });
    const all = [...found.arrays[ofSpeed ? "V_max" : "amplitude"], ...(ofSpeed ? [this.steadyAt(low), this.steadyAt(high)] : [])];
    const [first, last] = all.reduce(([a, b], y) => [Math.min(a, y), Math.max(b, y)], ofSpeed ? [Infinity, 0] : [0, LEAST]);
    if (ofSpeed) {
      const room = (last / first) ** ROOM * 1.2;
      Object.assign(plane.y, { log: true, low: first / room, high: last * room, label: [...parts("V_max"), ["", "  [m/s]"]] });
    } else {
      Object.assign(plane.y, { log: false, low: -ROOM * last, high: (1 + ROOM) * last, label: [["", "amplitude of "], ...parts("tau/sigma")] });
    }
    plane.y.ticks = (wanted) => (ofSpeed ? zoomed : linear)(plane.y.low, plane.y.high, wanted).filter(([value]) => value >= 0);
  }

  /** Where steady sliding is drawn at a value of the parameter. */
  steadyAt(value) {
    if (!this.ofSpeed) return 0;
    return this.found.along === "V_lp" ? value : this.V_lp;
  }

  drawSteady(c) {
    const { low, high, hopf, stable_at_low: first } = this.found;
    const ends = [low, ...hopf, high];
    for (let i = 0; i + 1 < ends.length; i += 1) {
      c.setLineDash((i % 2 === 0) === first ? [] : DASH);
      const xs = [ends[i], ends[i + 1]];
      this.plane.curve(xs, xs.map((x) => this.steadyAt(x)), color(this.isOld ? "run" : "text"), 1.8);
    }
  }

  drawCycles(c) {
    const { sizes, arrays: { parameter: x, stable, ...measures } } = this.found;
    const y = measures[this.measure];
    let end = 0;
    for (const size of sizes) {
      let from = end;
      end += size;
      for (let i = from + 1; i < end; i += 1) {
        if (i + 1 < end && stable[i] === stable[from]) continue;
        c.setLineDash(stable[from] ? [] : DASH);
        this.plane.curve(x.subarray(from, i + 1), y.subarray(from, i + 1), color(this.isOld ? "run" : "cycle"), stable[from] ? 2 : 1.4);
        from = i;
      }
    }
  }

  /** Bifurcation points: their names and places. */
  marks() {
    const { hopf, special } = this.found;
    const births = hopf.map((x) => ["hopf", x, this.steadyAt(x)]);
    return [...births, ...special.map((point) => [point.kind, point.parameter, point[this.measure]])];
  }

  drawMark([kind, x, y]) {
    const { plane } = this;
    const c = plane.context;
    const [X, Y] = [plane.X(x), plane.Y(y)];
    c.beginPath();
    if (kind === "hopf") c.arc(X, Y, 4, 0, 2 * Math.PI);
    else for (const [dx, dy] of [[0, -5], [4.5, 3.5], [-4.5, 3.5]]) c.lineTo(X + dx, Y + dy);
    c.closePath();
    c.fillStyle = color(kind === "hopf" ? "jump" : "card");
    c.fill();
    c.lineWidth = 1.4;
    c.strokeStyle = color("text");
    c.stroke();
    this.write(NAMES[kind], X, Y);
  }

  /** Name a point, on the side where the branch is not. */
  write(text, X, Y) {
    const { plane, found: { arrays }, ofSpeed } = this;
    const c = plane.context;
    const [xs, ys] = [arrays.parameter, arrays[this.measure]];
    const distances = Array.from(xs, (x, i) => Math.hypot(plane.X(x) - X, plane.Y(ys[i]) - Y));
    const nearest = distances.indexOf(Math.min(...distances));
    const beside = [...xs.subarray(Math.max(0, nearest - BESIDE), nearest + BESIDE + 1)].map((x) => plane.X(x));
    const isLeft = beside.reduce((sum, x) => sum + x - X, 0) > 0;
    c.font = `12px ${FONT}`;
    c.textAlign = isLeft ? "right" : "left";
    c.textBaseline = "alphabetic";
    const at = [X + (isLeft ? -8 : 8), Y + (ofSpeed && !isLeft ? 16 : -8)];
    c.lineWidth = 3;
    c.strokeStyle = color("card");
    c.strokeText(text, ...at);
    c.fillStyle = color("text");
    c.fillText(text, ...at);
  }
}
