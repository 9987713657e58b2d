// Which part of the map is shown, and of which part finer cells are asked for.

const LEAST = { ratio: 2e-4, eta: 0.02 }; // decades shown at most closely
const FINE = { ratio: 0.5, eta: 1 }; // decades of the finer part about the slider
const GRID = 4; // such parts begin on multiples of their size over this, so that moving back finds them again
const DIGITS = 4; // of what is set on the whole map

export class MapView {
  /** axes: {ratio, eta}, those of the plane, whose low and high this sets */
  constructor(axes) {
    Object.assign(this, { axes, whole: null, limits: null, fine: null });
  }

  /** span: {ratio: [low, high], eta: [low, high]} of the whole map */
  open(span) {
    this.whole = mapped((name) => span[name].map(Math.log10));
    this.show(this.whole);
  }

  show(limits) {
    this.limits = limits;
    for (const [name, axis] of Object.entries(this.axes)) {
      [axis.low, axis.high] = limits[name].map((at, i) => (at === this.whole[name][i] ? exactly(at) : 10 ** at));
    }
  }

  get isWhole() {
    return this.limits === this.whole;
  }

  get isClosest() {
    return Object.keys(LEAST).every((name) => width(this.limits[name]) < 1.001 * LEAST[name]);
  }

  get middle() {
    return mapped((name) => 10 ** ((this.limits[name][0] + this.limits[name][1]) / 2));
  }

  /** Decades shown over those of the whole map, along an axis. */
  share(name) {
    return width(this.limits[name]) / width(this.whole[name]);
  }

  /** Digits that tell neighbouring pixels apart. */
  get digits() {
    return DIGITS + Math.ceil(-Math.log10(this.share("ratio")));
  }

  showWhole() {
    this.show(this.whole);
  }

  /** Show so many times the decades; about {ratio, eta}, which stays where it is, or comes to the middle. */
  zoom(times, about) {
    const limits = mapped((name) => {
      const [low, high] = this.limits[name];
      const at = Math.log10(about[name]);
      const size = Math.min(Math.max(times * (high - low), LEAST[name]), width(this.whole[name]));
      const share = at >= low && at <= high ? (at - low) / (high - low) : 0.5;
      return this.inside(name, at - share * size, size);
    });
    const isWhole = Object.keys(limits).every((name) => width(limits[name]) > 0.999 * width(this.whole[name]));
    this.show(isWhole ? this.whole : limits);
  }

  /** Follow a slider that has left what is shown. */
  follow(at) {
    if (this.isWhole || this.holds(this.limits, at) || !this.holds(this.whole, at)) return;
    this.zoom(1, at);
  }

  /** The part of which finer cells are wanted, as the server takes it: all that is shown, or about the slider. */
  wanted(at) {
    const limits = this.isWhole ? this.about(at) : this.limits;
    return ["ratio", "eta"].flatMap((name) => limits[name].map((end, i) => (end === this.whole[name][i] ? exactly(end) : 10 ** end)));
  }

  /** A part about the slider: that of before, as long as the slider is in the middle half of it. */
  about(at) {
    const middle = this.fine && mapped((name) => [0.25, 0.75].map((share) => this.fine[name][0] + share * FINE[name]));
    if (!middle || !this.holds(middle, at)) {
      this.fine = mapped((name) => {
        const step = FINE[name] / GRID;
        return this.inside(name, step * Math.round((Math.log10(at[name]) - FINE[name] / 2) / step), FINE[name]);
      });
    }
    return this.fine;
  }

  holds(limits, at) {
    return Object.keys(limits).every((name) => {
      const x = Math.log10(at[name]);
      return x >= limits[name][0] && x <= limits[name][1];
    });
  }

  /** Limits from low on, of this size, moved into the map. */
  inside(name, low, size) {
    const [first, last] = this.whole[name];
    if (low <= first) return [first, first + size];
    return low + size >= last ? [last - size, last] : [low, low + size];
  }
}

function mapped(limits) {
  return { ratio: limits("ratio"), eta: limits("eta") };
}

function width([low, high]) {
  return high - low;
}

/** A whole power of ten as the server has it. */
function exactly(power) {
  return Number(`1e${Math.round(power)}`);
}
