// A canvas with two axes, each linear or logarithmic.

import { fit } from "./canvas.js";
import { element } from "./dom.js";
import { writeLabel } from "./labels.js";
import { FONT, color } from "./theme.js";
import { linear, logarithmic } from "./ticks.js";

const MARGIN = { left: 64, right: 12, top: 8, bottom: 40 };

export class Plane {
  /** x, y: {low, high, log, label, ticks}; changed at will before `frame` */
  constructor(canvas, x, y) {
    Object.assign(this, { canvas, x, y, context: canvas.getContext("2d") });
  }

  /** Explain the axes where their names are. */
  explain(x, y) {
    for (const [side, meaning] of [["x", x], ["y", y]]) {
      const name = element("span", { className: `axis-name ${side}` });
      name.dataset.meaning = meaning;
      this.canvas.after(name);
    }
  }

  /** Fit the canvas to its box, and clear it. */
  begin() {
    const [width, height] = fit(this.canvas, this.context, color("card"));
    this.box = { left: MARGIN.left, top: MARGIN.top, width: width - MARGIN.left - MARGIN.right, height: height - MARGIN.top - MARGIN.bottom };
  }

  share(axis, value) {
    if (axis.log) return Math.log(value / axis.low) / Math.log(axis.high / axis.low);
    return (value - axis.low) / (axis.high - axis.low);
  }

  X(value) {
    return this.box.left + this.box.width * this.share(this.x, value);
  }

  Y(value) {
    return this.box.top + this.box.height * (1 - this.share(this.y, value));
  }

  /** The value of an axis at a share of it. */
  static at(axis, share) {
    return axis.log ? axis.low * (axis.high / axis.low) ** share : axis.low + share * (axis.high - axis.low);
  }

  /** Values at a point of the canvas, held inside the axes. */
  values(px, py) {
    const hold = (share) => Math.min(1, Math.max(0, share));
    const { left, top, width, height } = this.box;
    return [Plane.at(this.x, hold((px - left) / width)), Plane.at(this.y, hold(1 - (py - top) / height))];
  }

  /** Whether a point of the canvas lies between the axes. */
  isInside(px, py) {
    const { left, top, width, height } = this.box;
    return px >= left && px <= left + width && py >= top && py <= top + height;
  }

  /** Axes with ticks and labels. */
  frame() {
    const c = this.context;
    const { left, top, width, height } = this.box;
    c.lineWidth = 1;
    c.font = `11px ${FONT}`;
    c.strokeStyle = color("rule");
    c.fillStyle = color("muted");
    c.textAlign = "center";
    c.textBaseline = "top";
    for (const [value, text] of this.ticks(this.x, width / 62)) {
      const at = Math.round(this.X(value)) + 0.5;
      this.stroke([at, top], [at, top + height]);
      c.fillText(text, Math.min(at, left + width - 8), top + height + 5);
    }
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const [value, text] of this.ticks(this.y, height / 34)) {
      const at = Math.round(this.Y(value)) + 0.5;
      this.stroke([left, at], [left + width, at]);
      c.fillText(text, left - 6, at);
    }
    c.strokeStyle = color("edge");
    c.strokeRect(left + 0.5, top + 0.5, width - 1, height - 1);
    writeLabel(c, this.x.label, left + width / 2, top + height + MARGIN.bottom - 6);
    c.save();
    c.translate(11, top + height / 2);
    c.rotate(-Math.PI / 2);
    writeLabel(c, this.y.label, 0, 0);
    c.restore();
  }

  ticks(axis, wanted) {
    const all = axis.ticks?.(wanted) ?? (axis.log ? logarithmic : linear)(axis.low, axis.high, wanted);
    return all.filter(([value]) => {
      const at = this.share(axis, value);
      return at >= -1e-6 && at <= 1 + 1e-6;
    });
  }

  /** Draw only inside the axes. */
  inside(draw) {
    const c = this.context;
    const { left, top, width, height } = this.box;
    c.save();
    c.beginPath();
    c.rect(left, top, width, height);
    c.clip();
    draw(c);
    c.restore();
  }

  stroke(from, to) {
    this.context.beginPath();
    this.context.moveTo(...from);
    this.context.lineTo(...to);
    this.context.stroke();
  }

  /** A curve through points of the axes. */
  curve(xs, ys, style, width) {
    const c = this.context;
    const [ax, bx] = this.affine(this.x, this.box.left, this.box.width);
    const [ay, by] = this.affine(this.y, this.box.top + this.box.height, -this.box.height);
    const fx = this.x.log ? Math.log : Number;
    const fy = this.y.log ? Math.log : Number;
    c.beginPath();
    for (let i = 0; i < xs.length; i += 1) c.lineTo(ax + bx * fx(xs[i]), ay + by * fy(ys[i]));
    c.strokeStyle = style;
    c.lineWidth = width;
    c.lineJoin = "round";
    c.stroke();
  }

  affine(axis, start, length) {
    const f = axis.log ? Math.log : Number;
    const scale = length / (f(axis.high) - f(axis.low));
    return [start - scale * f(axis.low), scale];
  }
}
