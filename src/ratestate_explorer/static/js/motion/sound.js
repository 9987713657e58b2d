// The vibration as sound, off until asked for.

import { plain, shown } from "../common/numbers.js";
import { octaves, soundOf } from "./vibration.js";

const FADE = 0.012; // s: time constant with which one sound gives way to the next, without a click
const OVER = 10 * FADE;

/** One sound, which goes on until it is ended. */
export class Voice {
  /** pitch: frequency at which it is heard [Hz]; into: AudioNode */
  constructor(context, { cycle_time: time, cycle_V: V }, pitch, into) {
    const { samples, rate } = soundOf(time, V, pitch, context.sampleRate);
    const buffer = context.createBuffer(1, samples.length, context.sampleRate);
    buffer.copyToChannel(samples, 0);
    this.context = context;
    this.gain = new GainNode(context, { gain: 0 });
    this.source = new AudioBufferSourceNode(context, { buffer, loop: true, playbackRate: rate });
    this.source.connect(this.gain).connect(into);
    this.gain.gain.setTargetAtTime(1, context.currentTime, FADE);
    this.source.start();
  }

  end() {
    const { currentTime } = this.context;
    this.gain.gain.setTargetAtTime(0, currentTime, FADE);
    this.source.stop(currentTime + OVER);
  }
}

/** A view of pictures. */
export class Sound {
  /** button: turns it on and off; volume: its slider; heard: element that says what is played */
  constructor(button, volume, heard) {
    Object.assign(this, { button, volume, heard, picture: null, context: null, voice: null, on: false, timer: 0 });
    button.addEventListener("click", () => this.toggle());
    volume.addEventListener("input", () => this.level());
    document.addEventListener("visibilitychange", () => this.rest());
  }

  toggle() {
    this.on = !this.on;
    this.button.ariaPressed = String(this.on);
    this.open();
    this.play();
    this.rest();
  }

  /** Audio may begin only once a person has asked for it. */
  open() {
    if (this.context) return;
    this.context = new AudioContext();
    this.output = new GainNode(this.context, { gain: 0 });
    this.output.connect(this.context.destination);
  }

  get isHeard() {
    return this.on && !document.hidden;
  }

  /** Use no processor while nothing is asked for, or nobody looks. */
  rest() {
    if (!this.context) return;
    clearTimeout(this.timer);
    if (this.isHeard) this.context.resume();
    else this.timer = setTimeout(() => this.context.suspend(), 1000 * OVER);
    this.level();
  }

  level() {
    if (!this.context) return;
    const level = this.isHeard ? Number(this.volume.value) ** 2 : 0; // hearing is logarithmic
    this.output.gain.setTargetAtTime(level, this.context.currentTime, FADE);
  }

  show(picture) {
    this.picture = picture;
    if (this.on) this.play();
  }

  /** Play the cycle that is shown, in place of what was played. */
  play() {
    const { arrays, numbers } = this.picture ?? {};
    this.voice?.end();
    this.voice = null;
    this.heard.hidden = !this.on;
    if (!this.on || !this.picture) return;
    const { frequency } = numbers;
    if (!arrays.cycle_V) {
      this.heard.textContent = numbers.stable ? "steady sliding: silent" : "no limit cycle: silent";
      return;
    }
    const raised = octaves(frequency);
    this.voice = new Voice(this.context, arrays, frequency * 2 ** raised, this.output);
    this.heard.textContent = `${shown(frequency, "Hz", 3)}${asFast(raised)}`;
  }
}

/** How fast it is played, unless as it is. */
function asFast(raised) {
  const times = plain(2 ** Math.abs(raised), 3);
  return raised === 0 ? "" : `, played ${times} times as ${raised > 0 ? "fast" : "slowly"}`;
}
