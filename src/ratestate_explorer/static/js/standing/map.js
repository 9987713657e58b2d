// The map: K/K_c_qs and eta, with K_c, the atlas behind where there is one, and the user's slider as a dot.

import { drawDot, placed } from "../common/dot.js";
import { Handle } from "../common/handle.js";
import { writeLabel } from "../common/labels.js";
import { Legend, REGIMES } from "./legend.js";
import { MapView } from "./map_view.js";
import { plain } from "../common/numbers.js";
import { Plane } from "../common/plane.js";
import { RegimeCells } from "./regime_cells.js";
import { FONT, color, onTheme } from "../common/theme.js";
import { zoomed } from "../common/ticks.js";
import { number } from "../common/wire.js";
import { parts } from "../common/words.js";

const ARROW = 0.02; // decades of K on the whole map, and twice that of eta
const HALO = 12; // px about the dot in the colour of its regime, however coarse the cells are

export class StabilityMap {
  /**
   * move: function (K/K_c_qs, eta, digits, event's time stamp), called while the dot moves
   * whenRead: function (act) that acts once the place of the dot is that of what was typed
   * pins: Pins
   *
   * target is where the dot was sent before it is drawn there; the page clears it.
   */
  constructor(canvas, dot, key, move, whenRead, pins) {
    const axis = (label) => ({ log: true, label, ticks: null });
    this.plane = new Plane(canvas, axis(["K", " / ", "K_c_qs"].flatMap(parts)), axis(parts("eta")));
    for (const of of [this.plane.x, this.plane.y]) of.ticks = (wanted) => zoomed(of.low, of.high, wanted);
    this.plane.explain("K/K_c_qs", "eta");
    Object.assign(this, { move, pins, atlas: null, part: null, target: null });
    this.whenRead = (act) => (this.target ? act() : whenRead(act));
    this.view = new MapView({ ratio: this.plane.x, eta: this.plane.y });
    this.legend = new Legend(key);
    this.handle = new Handle(canvas, dot, {
      isUsable: () => this.at,
      drag: (x, y, stamp) => {
        const [ratio, eta] = this.plane.values(x, y);
        this.whenRead(() => this.send({ ratio, eta }, stamp));
      },
      step: (way, stamp) => this.whenRead(() => this.step(way, stamp)),
    });
    onTheme(() => {
      this.atlas?.paint();
      this.part?.paint();
    });
  }

  /** The atlas for the law and b/a shown; null while it is not known. */
  behind(chart) {
    this.atlas = chart && new RegimeCells(chart);
    if (!chart) this.part = null;
    this.draw();
  }

  /** Finer cells of a part of it. */
  refine(window) {
    this.part = new RegimeCells(window);
    this.draw();
  }

  /** No atlas will come, unless one is there already. */
  missing() {
    if (!this.atlas) this.legend.clear();
  }

  show({ values, numbers, arrays }) {
    const before = this.at;
    this.picture = { numbers, arrays };
    this.at = standingOf({ values, numbers });
    if (this.at && (this.at.ratio !== before?.ratio || this.at.eta !== before?.eta)) this.view.follow(this.at);
    this.draw();
  }

  /** K_c as [[ratio, eta], ...]: along the whole map, exactly at the slider, and closely in the finer part. */
  line() {
    const { numbers, arrays } = this.picture;
    const coarse = Array.from(arrays.line_eta, (eta, i) => [arrays.line_ratio[i], eta]);
    if (!this.at) return coarse;
    const own = this.at.eta > 0 ? [[number(numbers.K_c) / numbers.K_c_qs, this.at.eta]] : [];
    if (!this.part) return [...coarse, ...own].sort(([, a], [, b]) => a - b);
    const { eta, K_c_over_K_c_qs: ratio } = this.part;
    const beside = [...coarse, ...own].filter(([, at]) => at < eta[0] || at > eta.at(-1));
    return [...beside, ...Array.from(eta, (at, i) => [ratio[i], at])].sort(([, a], [, b]) => a - b);
  }

  draw() {
    if (!this.picture || !this.plane.canvas.clientWidth) return; // or behind the other tab
    const { plane, at, atlas, part } = this;
    const line = this.line();
    plane.begin();
    if (at) for (const cells of [atlas, part]) cells?.draw(plane, line);
    plane.frame();
    if (at) {
      (part?.covers(plane) ? part : atlas)?.hatch(plane);
      this.drawLine(line);
    } else {
      this.drawNothing();
    }
    this.put();
    this.legend.tell(atlas, part, this.picture.numbers.regime, plane);
  }

  /** K_c; in another colour where sliding is lost with a jump. */
  drawLine(line) {
    const { plane, atlas } = this;
    const curve = (points, style, width) => plane.curve(points.map(([x]) => x), points.map(([, y]) => y), style, width);
    plane.inside((c) => {
      curve(line, color("text"), 1.8);
      if (atlas && atlas.eta_bautin !== null) {
        const { left, top, width, height } = plane.box;
        const first = Math.max(top, plane.Y(atlas.eta_bautin));
        c.save();
        c.beginPath();
        c.rect(left, first, width, Math.max(0, top + height - first));
        c.clip();
        curve(line, color("jump"), 2.2);
        c.restore();
      }
      c.fillStyle = color("on-map");
      if (this.view.isWhole) writeLabel(c, parts("K_c"), plane.X(1.6), plane.Y(1e-14));
    });
  }

  drawNothing() {
    const { left, top, width, height } = this.plane.box;
    this.plane.inside((c) => {
      c.font = `13px ${FONT}`;
      c.textAlign = "center";
      c.fillStyle = color("muted");
      c.fillText("Friction does not weaken with velocity,", left + width / 2, top + height / 2 - 10);
      c.fillText("and sliding is steady at any stiffness", left + width / 2, top + height / 2 + 10);
    });
  }

  put() {
    const { plane, at, handle } = this;
    handle.dot.hidden = !at;
    this.legend.place(false);
    if (!at) return;
    const { px, py, isBeyond } = placed(plane, at.ratio, at.eta);
    this.legend.place(isBeyond);
    const role = REGIMES.find(({ regime }) => regime === this.picture.numbers.regime)?.role;
    if (!isBeyond && role) plane.inside((c) => drawHalo(c, px, py, role));
    for (const pin of this.pins.all) this.markPin(pin);
    drawDot(plane.context, px, py, isBeyond);
    handle.put(px, py);
    const where = `K/K_c_qs = ${plain(at.ratio)}, eta = ${plain(at.eta)}${isBeyond ? ", beyond the map" : ""}`;
    handle.dot.setAttribute("aria-label", `The slider on the map: ${where}; arrow keys move it, + and \u2212 zoom, 0 shows the whole map`);
  }

  markPin({ role, picture }) {
    const at = standingOf(picture);
    if (!at) return;
    this.plane.inside((c) => {
      c.beginPath();
      c.arc(this.plane.X(at.ratio), this.plane.Y(at.eta), 4, 0, 2 * Math.PI);
      c.fillStyle = color(role);
      c.fill();
    });
  }

  step([right, up], stamp) {
    const { ratio, eta } = this.target ?? this.at;
    const far = (name, steps) => 10 ** (ARROW * this.view.share(name) * steps);
    this.send({ ratio: ratio * far("ratio", right), eta: eta * far("eta", 2 * up) }, stamp);
  }

  send(target, stamp) {
    this.move(target.ratio, target.eta, this.view.digits, stamp);
    this.target = target;
  }
}

/** {ratio, eta} of a picture's slider; null where there is no K_c_qs. */
function standingOf({ values, numbers }) {
  return numbers.K_c_qs > 0 ? { ratio: number(values.K) / numbers.K_c_qs, eta: number(numbers.eta) } : null;
}

function drawHalo(c, px, py, role) {
  c.beginPath();
  c.arc(px, py, HALO, 0, 2 * Math.PI);
  c.fillStyle = color(role);
  c.fill();
  c.lineWidth = 1;
  c.strokeStyle = color("edge");
  c.stroke();
}
