// The map: K/K_c_qs and eta, with K_c, the atlas behind where there is one, and the user's slider as a dot.

import { writeLabel } from "./labels.js";
import { Legend, REGIMES } from "./legend.js";
import { plain } from "./numbers.js";
import { Plane } from "./plane.js";
import { FONT, color, onTheme } from "./theme.js";
import { number } from "./wire.js";
import { parts } from "./words.js";

const ARROW = 0.02; // decades of K, and twice that of eta; with Shift ten times as far

export class StabilityMap {
  /**
   * move: function (K/K_c_qs, eta, event's time stamp), called while the dot moves
   * whenRead: function (act) that acts once the place of the dot is that of what was typed
   * pins: Pins
   *
   * target is where the dot was sent before it is drawn there; the page clears it.
   */
  constructor(canvas, dot, key, move, whenRead, pins) {
    this.plane = new Plane(canvas, { log: true, label: ["K", " / ", "K_c_qs"].flatMap(parts) }, { log: true, label: parts("eta") });
    Object.assign(this, { canvas, dot, move, whenRead, pins });
    this.legend = new Legend(key);
    this.listen();
    onTheme(() => this.paint());
  }

  /** The axes. */
  open(span) {
    [this.plane.x.low, this.plane.x.high] = span.ratio;
    [this.plane.y.low, this.plane.y.high] = span.eta;
  }

  /** The atlas for the law and b/a shown; null while it is not known. */
  behind(chart) {
    this.chart = chart;
    this.legend.tell(chart);
    this.paint();
    this.draw();
  }

  /** No atlas will come, unless one is there already. */
  missing() {
    if (!this.chart) this.legend.clear();
  }

  paint() {
    if (!this.chart) return;
    const { K_over_K_c_qs: x, eta: y, regime } = this.chart.arrays;
    const image = new OffscreenCanvas(x.length, y.length);
    const c = image.getContext("2d");
    for (let i = 0; i < y.length; i += 1) {
      let last = 0;
      for (let k = 0; k < x.length; k += 1) {
        // Cycles end at K_c, amid cells: the last one's colour goes on, and `backdrop` cuts it there.
        last = regime[i * x.length + k] || last;
        c.fillStyle = color(REGIMES[last][1]);
        c.fillRect(k, y.length - 1 - i, 1, 1);
      }
    }
    this.image = image;
  }

  show({ values, numbers, arrays }) {
    this.line = arrays; // line_eta, line_ratio: K_c over K_c_qs along eta
    this.at = placeOf({ values, numbers });
    this.draw();
  }

  draw() {
    if (!this.line) return;
    const { plane, at } = this;
    plane.begin();
    if (this.chart) this.backdrop();
    plane.frame();
    plane.inside((c) => {
      if (!at) {
        c.font = `13px ${FONT}`;
        c.textAlign = "center";
        c.fillStyle = color("muted");
        c.fillText("Friction does not weaken with velocity,", plane.box.left + plane.box.width / 2, plane.box.top + plane.box.height / 2 - 10);
        c.fillText("and sliding is steady at any stiffness", plane.box.left + plane.box.width / 2, plane.box.top + plane.box.height / 2 + 10);
        return;
      }
      plane.curve(this.line.line_ratio, this.line.line_eta, color("text"), 1.8);
      this.jumps();
      c.fillStyle = color("on-map");
      writeLabel(c, parts("K_c"), plane.X(1.6), plane.Y(1e-14));
    });
    for (const pin of this.pins.all) this.markPin(pin);
    this.put(at);
  }

  backdrop() {
    const { plane } = this;
    const c = plane.context;
    const { K_over_K_c_qs: x, eta: y } = this.chart.arrays;
    // cells are centred on their points
    const dx = (x.at(-1) / x[0]) ** (0.5 / (x.length - 1));
    const dy = (y.at(-1) / y[0]) ** (0.5 / (y.length - 1));
    const [left, right] = [plane.X(x[0] / dx), plane.X(x.at(-1) * dx)];
    const [top, bottom] = [plane.Y(y.at(-1) * dy), plane.Y(y[0] / dy)];
    plane.inside(() => {
      c.imageSmoothingEnabled = false;
      c.fillStyle = color(REGIMES[0][1]);
      c.fillRect(left, top, right - left, bottom - top);
      const { line_ratio: K_c, line_eta: eta } = this.line;
      c.beginPath();
      for (let i = 0; i < eta.length; i += 1) c.lineTo(plane.X(K_c[i]), plane.Y(eta[i]));
      c.lineTo(left, plane.Y(eta.at(-1)));
      c.lineTo(left, plane.Y(eta[0]));
      c.clip();
      c.drawImage(this.image, left, top, right - left, bottom - top);
    });
  }

  /** Where sliding is lost with a jump, in another colour. */
  jumps() {
    if (!this.chart) return;
    const { eta, K_c_over_K_c_qs: ratio, jumps } = this.chart.arrays;
    const first = jumps.indexOf(1);
    const last = jumps.lastIndexOf(1);
    if (first < 0) return;
    this.plane.curve(ratio.subarray(first, last + 1), eta.subarray(first, last + 1), color("jump"), 2.2);
  }

  put(at) {
    this.dot.hidden = !at || !this.plane.box;
    this.legend.place(false);
    if (this.dot.hidden) return;
    const { left, top, width, height } = this.plane.box;
    const hold = (x, low, high) => Math.min(high, Math.max(low, x));
    const [x, y] = [this.plane.X(at.ratio), at.eta > 0 ? this.plane.Y(at.eta) : Infinity];
    const [px, py] = [hold(x, left, left + width), hold(y, top, top + height)];
    const beyond = Math.hypot(px - x, py - y) > 1;
    this.legend.place(beyond);
    this.mark(px, py, beyond);
    this.dot.style.left = `${px}px`;
    this.dot.style.top = `${py}px`;
    const where = `K/K_c_qs = ${plain(at.ratio)}, eta = ${plain(at.eta)}${beyond ? ", beyond the map" : ""}`;
    this.dot.setAttribute("aria-label", `The slider on the map: ${where}; arrow keys move it`);
  }

  markPin({ role, picture }) {
    const at = placeOf(picture);
    if (!at) return;
    this.plane.inside((c) => {
      c.beginPath();
      c.arc(this.plane.X(at.ratio), this.plane.Y(at.eta), 4, 0, 2 * Math.PI);
      c.fillStyle = color(role);
      c.fill();
    });
  }

  /** The dot, on the canvas: pictures have it too; hollow beyond.  The button over it is what is grasped. */
  mark(px, py, beyond) {
    const c = this.plane.context;
    c.beginPath();
    c.arc(px, py, 6, 0, 2 * Math.PI);
    c.fillStyle = color(beyond ? "card" : "text");
    c.fill();
    c.lineWidth = 2;
    c.strokeStyle = color(beyond ? "text" : "card");
    c.stroke();
  }

  listen() {
    const box = this.canvas.parentElement;
    let dragging = false;
    const go = (event) => {
      const { left, top } = this.canvas.getBoundingClientRect();
      const [ratio, eta] = this.plane.values(event.clientX - left, event.clientY - top);
      this.whenRead(() => this.send({ ratio, eta }, event.timeStamp));
    };
    box.addEventListener("pointerdown", (event) => {
      if (!this.at || event.button !== 0) return;
      // A finger elsewhere wants to scroll the page.
      if (event.pointerType === "touch" && event.target !== this.dot) return;
      event.preventDefault();
      box.setPointerCapture(event.pointerId);
      this.dot.focus({ focusVisible: false });
      dragging = true;
      go(event);
    });
    box.addEventListener("pointermove", (event) => dragging && go(event));
    for (const end of ["pointerup", "pointercancel"]) box.addEventListener(end, () => (dragging = false));
    this.dot.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way || !this.at) return;
      event.preventDefault();
      const far = ARROW * (event.shiftKey ? 10 : 1);
      this.whenRead(() => {
        const { ratio, eta } = this.target ?? this.at;
        this.send({ ratio: ratio * 10 ** (far * way[0]), eta: eta * 10 ** (2 * far * way[1]) }, event.timeStamp);
      });
    });
  }

  send(target, stamp) {
    this.move(target.ratio, target.eta, stamp);
    this.target = target;
  }
}

/** {ratio, eta} of a picture's slider; null where there is no K_c_qs. */
function placeOf({ values, numbers }) {
  return numbers.K_c_qs > 0 ? { ratio: number(values.K) / numbers.K_c_qs, eta: number(numbers.eta) } : null;
}
