// The moment that all charts mark: where one of them is pointed at, else where the run is played.

export class Instant {
  constructor() {
    Object.assign(this, { pointed: null, played: null, listeners: [] });
  }

  /** Time [s] since the step, or since the start without one; null if there is none. */
  get time() {
    return this.pointed ?? this.played;
  }

  /** listener: function (time) that is told of each change */
  on(listener) {
    this.listeners.push(listener);
  }

  /** Point at a time, or at none. */
  point(time) {
    this.change({ pointed: time });
  }

  /** Play at a time, or at none. */
  play(time) {
    this.change({ played: time });
  }

  change(times) {
    const before = this.time;
    Object.assign(this, times);
    if (this.time !== before) for (const listener of this.listeners) listener(this.time);
  }
}
