// Zooming the map: by buttons, by keys on the dot, by the wheel with Ctrl, which a pinch on a touchpad is too.

const STEP = 2; // times the decades shown, by a button or a key
const WHEEL = 0.01; // of the logarithm, by a pixel of the wheel
const MOST = 100; // px of the wheel that count at a time

export class Zoom {
  /** map: StabilityMap; buttons: {closer, wider, whole}; changed: function (), called after each zoom */
  constructor(map, buttons, changed) {
    Object.assign(this, { map, buttons, changed });
    const { canvas, dot } = map.handle;
    buttons.closer.addEventListener("click", () => this.by(1 / STEP));
    buttons.wider.addEventListener("click", () => this.by(STEP));
    buttons.whole.addEventListener("click", () => this.by(Infinity));
    dot.addEventListener("keydown", (event) => {
      const times = { "+": 1 / STEP, "=": 1 / STEP, "-": STEP, 0: Infinity }[event.key];
      if (times && !event.ctrlKey && !event.metaKey) this.by(times);
    });
    canvas.parentElement.addEventListener("wheel", (event) => this.turn(event), { passive: false });
  }

  turn(event) {
    if (!event.ctrlKey || !this.map.at) return;
    event.preventDefault();
    const { left, top } = this.map.handle.canvas.getBoundingClientRect();
    const [ratio, eta] = this.map.plane.values(event.clientX - left, event.clientY - top);
    const turned = Math.max(-MOST, Math.min(MOST, event.deltaY));
    this.by(Math.exp(WHEEL * turned), { ratio, eta });
  }

  /** Show so many times the decades, about a point of the map or else the slider. */
  by(times, about = this.map.at) {
    const { view } = this.map;
    if (times === Infinity) view.showWhole();
    else if (about) view.zoom(times, view.holds(view.whole, about) ? about : view.middle);
    this.mark();
    this.map.draw();
    this.changed();
  }

  /** Mark which buttons there is a use for. */
  mark() {
    const { view } = this.map;
    this.buttons.whole.disabled = this.buttons.wider.disabled = view.isWhole;
    this.buttons.closer.disabled = view.isClosest;
  }
}
