// Axes and lines of the traces, for uPlot.

import uPlot from "../../vendor/uPlot.js";
import { FONT, color } from "../common/theme.js";

const PADDING = 0.06;

/** An axis in the page's colours. */
export function axis(more) {
  const grid = { stroke: () => color("rule"), width: 1 };
  const text = { stroke: () => color("muted"), font: `11px ${FONT}`, labelFont: `12px ${FONT}`, labelSize: 18, labelGap: 0 };
  return { ...text, grid, ticks: { ...grid, size: 4 }, gap: 4, ...more };
}

/** Ticks of a plot's y axis; what they say of its unit goes into the label. */
export function labelled(plot, name, ticks) {
  return (...asked) => {
    const [found, unit] = ticks(...asked);
    plot().axes[1].label = `${name}${unit}`;
    return found;
  };
}

/** splits and values of an axis that has its ticks from ticks.js */
export function ticking(ticks, pixels, side = "height") {
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
export function straight(plot, series, first, last) {
  const stroke = new Path2D();
  uPlot.orient(plot, series, (_, xs, ys, scaleX, scaleY, X, Y, left, top, width, height) => {
    for (let i = first; i <= last; i += 1) stroke.lineTo(X(xs[i], scaleX, width, left), Y(ys[i], scaleY, height, top));
  });
  return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 1 };
}

/** A range with room at both ends. */
export function padded([low, high]) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  const pad = Math.max(PADDING * (high - low), 1e-9 * Math.max(1, Math.abs(high)));
  return [low - pad, high + pad];
}

/** Draw on a plot's canvas, only inside its axes. */
export function insideAxes({ ctx, bbox }, draw) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(ctx);
  ctx.restore();
}

/** A frame about the plot, as on the other charts. */
export function outline({ ctx, bbox }) {
  ctx.save();
  ctx.strokeStyle = color("edge");
  ctx.lineWidth = devicePixelRatio;
  ctx.strokeRect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.restore();
}
