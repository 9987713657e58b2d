// The motion against time: tau/sigma with mu, and V on a logarithmic axis, or a linear one where slip reverses.

import uPlot from "../../vendor/uPlot.js";
import { changes, speedOf } from "../common/changes.js";
import { Dots } from "./dots.js";
import { inertia } from "./inertia.js";
import { timeUnit } from "../common/numbers.js";
import { tell } from "./readout.js";
import { extremes, valuesAt } from "../common/run.js";
import { color, onTheme } from "../common/theme.js";
import { TimeWindow } from "./time_window.js";
import { backward, counted, linear, speeds } from "../common/ticks.js";
import { axis, insideAxes, labelled, outline, padded, straight, ticking } from "./trace_axes.js";

const AXIS_WIDTH = 44;

export class Traces {
  /**
   * readout: element that tells values at the instant, and what the lines are; unzoom: button;
   * zoomed: function (), called when other times are shown, to draw them
   *
   * layers: what lies behind the lines: {draw(plot, name, X, Y, picture), range(name, first, last),
   * times(), key(time)} with name "stress" or "speed", functions of seconds and of values that give
   * pixels, the range of what is drawn between two times, its first and last time, and what the
   * legend says of it at a time, or for null without one.  Without range or times the axes do not
   * reach out for it.
   */
  constructor(stressBox, speedBox, readout, unzoom, instant, layers, zoomed) {
    Object.assign(this, { stressBox, speedBox, readout, instant, layers: [inertia, changes, ...layers] });
    this.window = new TimeWindow(this.layers, unzoom, zoomed);
    this.unit = [1, "s"];
    this.reverses = false;
    this.build();
    new ResizeObserver(() => this.fit()).observe(stressBox);
    onTheme(() => this.rebuild());
    instant.on(() => this.mark());
    this.mark();
  }

  get plots() {
    return [this.stress, this.speed];
  }

  build() {
    for (const plot of this.plots) plot?.destroy();
    const stresses = labelled(() => this.stress, "\u03c4/\u03c3,  \u03bc", counted);
    const rates = labelled(() => this.speed, "V", speeds);
    const line = (role, more) => ({ stroke: color(role), width: 1.4, points: { show: false }, paths: straight, ...more });
    const load = line("run", { width: 1, dash: [5, 4], paths: uPlot.paths.stepped({ align: 1 }) });
    const time = ticking(linear, 70, "width");
    this.stress = this.plot("stress", ["stress", "friction"], { range: (_, low, high) => padded(this.window.reach("stress", low, high)) }, this.stressBox, {
      axes: [axis({ ...time, values: (_, splits) => splits.map(() => ""), size: 8 }), axis({ size: AXIS_WIDTH, ...ticking(stresses, 40), label: "\u03c4/\u03c3,  \u03bc" })],
      series: [{}, line("stress", { width: 1.6 }), line("friction", { dash: [6, 4] })],
    });
    this.speed = this.plot("speed", ["speed"], this.speedScale(), this.speedBox, {
      axes: [axis({ size: 24, label: "Time", ...time }), axis({ size: AXIS_WIDTH, ...ticking(rates, 34), label: "V  [m/s]" })],
      series: [{}, load, line("speed")],
    });
    this.fit();
  }

  plot(name, roles, y, box, more) {
    const bind = { dblclick: () => () => this.window.show(null) };
    const options = {
      width: 300,
      height: 200,
      padding: [8, 12, 0, 0],
      legend: { show: false },
      cursor: { points: { show: false }, drag: { x: true, y: false, setScale: false }, bind },
      scales: { x: { time: false, range: () => this.window.shown().map((time) => time / this.unit[0]) }, y },
      hooks: {
        setSelect: [(plot) => this.select(plot)],
        drawAxes: [outline, (plot) => this.behind(plot, name)],
        // (what is marked moves with the axes, which are known from here on)
        draw: [(plot) => plot.dots && this.place(plot)],
      },
      ...more,
    };
    const plot = new uPlot(options, [[], [], []], box);
    plot.dots = new Dots(plot, roles);
    // (uPlot's own cursor is also set by new data, wherever the pointer is)
    plot.over.addEventListener("mousemove", () => this.point(plot));
    plot.over.addEventListener("mouseleave", () => this.instant.point(null));
    const meanings = ["t", { stress: "tau/sigma,mu", speed: "V" }[name]];
    plot.root.querySelectorAll(".u-axis").forEach((side, i) => (side.dataset.meaning = meanings[i]));
    return plot;
  }

  speedScale() {
    const range = (low, high) => this.window.reach("speed", low, high);
    if (this.reverses) return { range: (_, low, high) => padded(range(low, high)) };
    return { distr: 3, range: (_, low, high) => padded(range(low, high).map(Math.log)).map(Math.exp) };
  }

  rebuild() {
    this.build();
    this.draw();
  }

  fit() {
    this.stress.setSize({ width: this.stressBox.clientWidth, height: this.stressBox.clientHeight });
    this.speed.setSize({ width: this.speedBox.clientWidth, height: this.speedBox.clientHeight });
  }

  show(picture) {
    this.picture = picture;
    this.draw();
  }

  draw() {
    if (!this.picture) return;
    const { picture } = this;
    const { run_time: time, run_stress: stress, run_mu: mu, run_V: V } = picture.arrays;
    this.window.take(time);
    const [first, last] = this.window.whole();
    this.unit = timeUnit(Math.max((last - first) / 2, 1e-300));
    const t = time.map((value) => value / this.unit[0]);
    if (this.reverses !== backward(this.window.reach("speed", ...extremes([V]))[0])) {
      this.reverses = !this.reverses;
      this.build();
    }
    const load = Array.from(time, speedOf(picture)).map((value) => (value > 0 || this.reverses ? value : null)); // 0 has no logarithm
    this.speed.axes[0].label = `Time  [${this.unit[1]}]`;
    this.stress.setData([t, stress, mu]);
    this.speed.setData([t, load, V]);
    this.mark();
  }

  /** Zoom to what was dragged over. */
  select(plot) {
    const { left, width } = plot.select;
    if (!(width > 0)) return;
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.window.show([left, left + width].map((x) => plot.posToVal(x, "x") * this.unit[0]));
  }

  // ---- what is drawn beside the lines

  behind(plot, name) {
    if (!this.picture) return;
    const X = (time) => plot.valToPos(time / this.unit[0], "x", true);
    const Y = (value) => plot.valToPos(value, "y", true);
    insideAxes(plot, () => {
      for (const layer of this.layers) layer.draw(plot, name, X, Y, this.picture);
    });
  }

  // ---- the instant

  /** The pointer is where uPlot has its cursor. */
  point(plot) {
    if (this.picture) this.instant.point(plot.posToVal(plot.cursor.left, "x") * this.unit[0]);
  }

  /** Put line, dots and values where the instant is. */
  mark() {
    for (const plot of this.plots) this.place(plot);
    const { time } = this.instant;
    tell(this.readout, this.valuesAt(time), time, this.unit, this.picture, this.layers);
  }

  /** Put the cursor of a plot where the instant is, and dots onto its lines. */
  place(plot) {
    const { time } = this.instant;
    const at = this.valuesAt(time);
    const left = time !== null && this.picture ? plot.valToPos(time / this.unit[0], "x") : -10;
    // Where the pointer itself is, uPlot has the cursor, and perhaps drags.
    if (Math.abs(left - plot.cursor.left) > 0.01) plot.setCursor({ left, top: Math.sign(left) }, false, false);
    plot.dots.put(time / this.unit[0], at && (plot === this.stress ? [at.stress, at.mu] : [at.V]));
  }

  valuesAt(time) {
    return time !== null && this.picture ? valuesAt(this.picture.arrays, time) : null;
  }
}
