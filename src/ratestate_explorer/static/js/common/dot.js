// The dot that stands for the slider on a chart, on its canvas: figures have it too.

import { color } from "./theme.js";

/** Where a dot for these values is drawn: its place, held inside the axes, and whether it lies beyond. */
export function placed(plane, x, y) {
  const { left, top, width, height } = plane.box;
  const hold = (at, low, high) => Math.min(high, Math.max(low, at));
  const [X, Y] = [plane.X(x), plane.Y(y)];
  const [px, py] = [hold(X, left, left + width), hold(Y, top, top + height)];
  return { px, py, isBeyond: !(Math.hypot(px - X, py - Y) <= 1) };
}

/** Draw it: hollow where the slider is not at this place. */
export function drawDot(c, px, py, isHollow) {
  c.beginPath();
  c.arc(px, py, 6, 0, 2 * Math.PI);
  c.fillStyle = color(isHollow ? "card" : "text");
  c.fill();
  c.lineWidth = 2;
  c.strokeStyle = color(isHollow ? "text" : "card");
  c.stroke();
}
