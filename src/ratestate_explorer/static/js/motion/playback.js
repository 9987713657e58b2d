// Playing the run: a button, a slider of the playing time, and how fast that is.

import { Pace, paceText } from "./pace.js";
import { round } from "../common/numbers.js";

const STEPS = 2000; // of the slider
const LONGEST_FRAME = 0.1; // s: after a pause of the browser it goes on where it was
const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class Playback {
  /**
   * elements: {button, slider, speed, readout}
   * times: function that gives first and last time shown [s], which are played
   */
  constructor(elements, instant, times) {
    Object.assign(this, elements, { instant, times, share: 0, begun: false, frame: 0, pace: null });
    this.slider.max = STEPS;
    this.button.addEventListener("click", () => (this.isPlaying ? this.pause() : this.play()));
    this.speed.addEventListener("change", () => this.tell());
    this.slider.addEventListener("input", () => this.scrub());
    this.slider.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      this.button.click();
    });
    calm.addEventListener("change", () => calm.matches && this.pause());
  }

  get isPlaying() {
    return this.frame !== 0;
  }

  /** Another run is played at the same share, other times of the same run at the same time. */
  show(picture) {
    const { run_time: time } = picture.arrays;
    const [first, last] = this.times();
    const isSame = picture === this.picture;
    const before = isSame && this.pace ? this.pace.timeAt(this.share) : null;
    this.picture = picture;
    const some = time.length > 1 && first < time.at(-1) && last > time[0];
    this.pace = some ? new Pace(picture.arrays, [first, last]) : null;
    this.button.disabled = this.slider.disabled = !some;
    if (!some) this.pause();
    else if (before !== null) {
      const share = this.pace.shareAt(before);
      this.share = share >= 0 && share <= 1 ? share : 0;
    }
    this.put();
  }

  play() {
    this.begun = true;
    this.instant.point(null);
    if (this.share >= 1) this.share = 0;
    this.label("Pause");
    let earlier = null;
    const step = (now) => {
      this.frame = requestAnimationFrame(step);
      this.advance(earlier === null ? 0 : Math.min((now - earlier) / 1000, LONGEST_FRAME));
      earlier = now;
    };
    this.frame = requestAnimationFrame(step);
  }

  pause() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.label("Play");
  }

  /** Play for so many seconds; again from the start, unless those who mind motion have seen it once. */
  advance(seconds) {
    const share = this.share + (seconds * this.speed.value) / this.pace.duration;
    if (share < 1) this.share = share;
    else if (calm.matches) {
      this.share = 1;
      this.pause();
    } else this.share = share % 1;
    this.put();
  }

  /** The slider was moved. */
  scrub() {
    this.pause();
    this.begun = true;
    this.share = this.slider.value / STEPS;
    this.instant.point(null);
    this.put();
  }

  /** Bring all there where the run is played; before it ever was, only the slider. */
  put() {
    this.slider.value = Math.round(this.share * STEPS);
    this.instant.play(this.begun && this.pace ? this.pace.timeAt(this.share) : null);
    this.tell();
  }

  tell() {
    this.readout.textContent = this.pace ? paceText(this.speed.value * this.pace.factorAt(this.share)) : "";
    this.slider.setAttribute("aria-valuetext", this.pace ? `t = ${round(this.pace.timeAt(this.share), 5)} s` : "no run");
  }

  label(text) {
    this.button.textContent = text;
  }
}
