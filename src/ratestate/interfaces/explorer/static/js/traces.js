// The motion against time: tau/sigma with mu, and V on a logarithmic axis, or a linear one where slip reverses.

import uPlot from "../vendor/uPlot.js";
import { element } from "./dom.js";
import { round, shown, timeUnit } from "./numbers.js";
import { FONT, color, onTheme } from "./theme.js";
import { backward, counted, linear, speeds } from "./ticks.js";

const AXIS_WIDTH = 44;
const PADDING = 0.06;
const LOGARITHMIC = { distr: 3, range: (_, low, high) => padded(Math.log(low), Math.log(high)).map(Math.exp) };

export class Traces {
  /** readout: element that tells values at the pointer, and what the lines are */
  constructor(stressBox, speedBox, readout) {
    Object.assign(this, { stressBox, speedBox, readout });
    this.unit = [1, "s"];
    this.reverses = false;
    this.build();
    new ResizeObserver(() => this.fit()).observe(stressBox);
    onTheme(() => {
      this.build();
      this.draw(this.picture);
    });
    this.tell(null);
  }

  build() {
    this.stress?.destroy();
    this.speed?.destroy();
    const sync = { key: "time", setSeries: false };
    const common = {
      width: 300,
      height: 200,
      padding: [8, 12, 0, 0],
      legend: { show: false },
      cursor: { sync, points: { size: 6 }, drag: { x: true, y: false } },
      hooks: { setCursor: [(plot) => this.tell(plot.cursor.idx)], drawAxes: [outline], draw: [(plot) => this.stepLine(plot)] },
    };
    const line = (role, more) => ({ stroke: color(role), width: 1.4, points: { show: false }, paths: straight, ...more });
    const y = (ticks, label) => axis({ size: AXIS_WIDTH, label, ...ticks });
    const stresses = labelled(() => this.stress, "\u03c4/\u03c3,  \u03bc", counted);
    const rates = labelled(() => this.speed, "V", speeds);
    this.stress = new uPlot(
      {
        ...common,
        scales: { x: { time: false }, y: { range: (_, low, high) => padded(low, high) } },
        axes: [axis({ ...this.times(), values: (_, splits) => splits.map(() => ""), size: 8 }), y(ticking(stresses, 40), "\u03c4/\u03c3,  \u03bc")],
        series: [{}, line("stress", { width: 1.6 }), line("friction", { dash: [6, 4] })],
      },
      [[], [], []],
      this.stressBox,
    );
    this.speed = new uPlot(
      {
        ...common,
        scales: { x: { time: false }, y: this.reverses ? { range: (_, low, high) => padded(low, high) } : LOGARITHMIC },
        axes: [axis({ size: 24, label: "Time", ...this.times() }), y(ticking(rates, 34), "V  [m/s]")],
        series: [{}, line("run", { width: 1, dash: [5, 4], paths: uPlot.paths.stepped({ align: 1 }) }), line("speed")],
      },
      [[], [], []],
      this.speedBox,
    );
    this.fit();
  }

  /** Ticks of the time axis: round values of what is shown. */
  times() {
    return ticking(linear, 70, "width");
  }

  fit() {
    for (const [plot, box] of [[this.stress, this.stressBox], [this.speed, this.speedBox]]) {
      plot.setSize({ width: box.clientWidth, height: box.clientHeight });
    }
  }

  draw(picture) {
    if (!picture) return;
    this.picture = picture;
    const { run_time: time, run_stress: stress, run_mu: mu, run_V: V } = picture.arrays;
    const span = time.length ? time.at(-1) - time[0] : 1;
    this.unit = timeUnit(Math.max(span / 2, 1e-300));
    const t = time.map((value) => value / this.unit[0]);
    const { V_from, V_lp } = picture.values;
    const load = time.map((value) => (value < 0 ? (V_from ?? V_lp) : V_lp));
    this.data = { t, stress, mu, V, load };
    if (this.reverses !== V.some(backward)) {
      this.reverses = !this.reverses;
      this.build();
    }
    this.speed.axes[0].label = `Time  [${this.unit[1]}]`;
    this.stress.setData([t, stress, mu]);
    this.speed.setData([t, load, V]);
    this.tell(null);
  }

  /** A line where the load point or the normal stress steps: what is before it has times below 0. */
  stepLine(plot) {
    if (!(this.data?.t[0] < 0)) return;
    const x = Math.round(plot.valToPos(0, "x", true));
    const { top, height } = plot.bbox;
    plot.ctx.save();
    plot.ctx.strokeStyle = color("edge");
    plot.ctx.setLineDash([3, 3]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }

  /** What the lines are; at the pointer, with values. */
  tell(index) {
    const d = index == null ? null : this.data;
    const parts = [
      ["stress", "\u03c4/\u03c3", d && d.stress[index].toPrecision(6)],
      ["friction", "\u03bc", d && d.mu[index].toPrecision(6)],
      ["speed", "V", d && shown(d.V[index], "m/s")],
    ].map(([role, name, value]) => element("span", {}, element("span", { className: `line ${role}` }), value ? `${name} = ${value}` : name));
    if (d) parts.push(`t = ${round(d.t[index], 5)} ${this.unit[1]}`);
    this.readout.replaceChildren(...parts);
  }
}

/** A frame about the plot, as on the other charts. */
function outline({ ctx, bbox }) {
  ctx.save();
  ctx.strokeStyle = color("edge");
  ctx.lineWidth = devicePixelRatio;
  ctx.strokeRect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.restore();
}

function axis(more) {
  const grid = { stroke: () => color("rule"), width: 1 };
  const text = { stroke: () => color("muted"), font: `11px ${FONT}`, labelFont: `12px ${FONT}`, labelSize: 18, labelGap: 0 };
  return { ...text, grid, ticks: { ...grid, size: 4 }, gap: 4, ...more };
}

/** Ticks of a plot's y axis; what they say of its unit goes into the label. */
function labelled(plot, name, ticks) {
  return (...asked) => {
    const [found, unit] = ticks(...asked);
    plot().axes[1].label = `${name}${unit}`;
    return found;
  };
}

/** splits and values of an axis that has its ticks from ticks.js */
function ticking(ticks, pixels, side = "height") {
  let texts = {};
  return {
    splits: (plot, _, low, high) => {
      const found = ticks(low, high, plot.bbox[side] / devicePixelRatio / pixels);
      texts = Object.fromEntries(found);
      return found.map(([value]) => value);
    },
    values: (_, splits) => splits.map((value) => texts[value]),
    filter: (_, splits) => splits, // on logarithmic axes uPlot would leave some out
  };
}

/** A line through every point; uPlot's own joins dense ones by pixel, which makes stairs of slopes. */
function straight(plot, series, first, last) {
  const stroke = new Path2D();
  uPlot.orient(plot, series, (_, xs, ys, scaleX, scaleY, X, Y, left, top, width, height) => {
    for (let i = first; i <= last; i += 1) stroke.lineTo(X(xs[i], scaleX, width, left), Y(ys[i], scaleY, height, top));
  });
  return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 1 };
}

function padded(low, high) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const pad = Math.max(PADDING * (high - low), 1e-9 * Math.max(1, Math.abs(high)));
  return [low - pad, high + pad];
}
