// Which times the traces show, and what range of values is drawn in them.

import { extremes } from "../common/run.js";

const NARROWEST = 1e-3; // of the whole time: what is kept of a zoom

export class TimeWindow {
  /** layers: of `Traces`; unzoom: button; zoomed: function (), called when other times are shown, to draw them */
  constructor(layers, unzoom, zoomed) {
    Object.assign(this, { layers, unzoom, zoomed, run: [], zoom: null }); // zoom: [first, last], or null for all
    unzoom.addEventListener("click", () => this.show(null));
  }

  /** First and last time of all that is drawn [s]. */
  whole() {
    const all = this.layers.flatMap((layer) => layer.times?.() ?? []);
    if (this.run.length) all.push(this.run[0], this.run.at(-1));
    return all.length ? extremes([all]) : [0, 1];
  }

  /** The same of what is shown. */
  shown() {
    return this.zoom ?? this.whole();
  }

  /** A range of values with those of the layers. */
  reach(name, low, high) {
    const shown = this.shown();
    const all = [[low, high], ...this.layers.flatMap((layer) => (layer.range ? [layer.range(name, ...shown)] : []))];
    return [Math.min(...all.map(([least]) => least)), Math.max(...all.map(([, most]) => most))];
  }

  /** Take the times of another run: of a zoom stays what that has too. */
  take(run) {
    this.run = run;
    if (!this.zoom) return;
    const [first, last] = this.whole();
    const kept = [Math.max(first, this.zoom[0]), Math.min(last, this.zoom[1])];
    this.zoom = kept[1] - kept[0] > NARROWEST * (last - first) ? kept : null;
    this.unzoom.disabled = !this.zoom;
  }

  /** Show these times [s], or all. */
  show(zoom) {
    this.zoom = zoom;
    this.unzoom.disabled = !zoom;
    this.zoomed();
  }
}
