// Guided tasks: which is begun, how far it has come, and whether what is shown does what it wants.

import { LESSONS, near } from "./lessons.js";
import { keep, recall } from "./kept.js";
import { shown } from "../common/numbers.js";
import { number } from "../common/wire.js";

const KEY = "tasks";
const NEVER = Infinity; // the id of a picture that could not be asked for

export class Tasks {
  /**
   * strip: TaskStrip; fields: [{symbol, unit}, ...]; presets: as the server sends them
   * begin: function (texts, event's time stamp) that shows these texts and gives the id of the picture asked for,
   * null without a connection
   */
  constructor(strip, fields, presets, begin) {
    Object.assign(this, { strip, presets, begin, asked: null, base: null, now: null });
    this.units = Object.fromEntries(fields.map(({ symbol, unit }) => [symbol, unit]));
    Object.assign(this, recalled());
    strip.listen({ choose: (index) => this.choose(index), start: (stamp) => this.start(stamp), forget: () => this.forget() });
    this.tell();
  }

  get lesson() {
    return LESSONS[this.index];
  }

  choose(index) {
    Object.assign(this, { index, asked: null, base: null });
    this.keep();
    this.tell();
  }

  /** Set the sliders to what the task begins with. */
  start(stamp) {
    const { entries } = this.presets.find(({ name }) => name === this.lesson.preset);
    this.base = null;
    this.asked = this.begin({ ...entries, ...this.lesson.texts }, stamp) ?? NEVER;
  }

  forget() {
    this.reached = noneReached();
    this.choose(0);
  }

  /** See whether a picture does what the task wants. */
  show(picture) {
    const isEarlier = picture.id < this.asked && this.asked !== NEVER;
    if (this.asked === null || isEarlier) return;
    this.now = momentOf(picture);
    if (!this.base && picture.id !== this.asked) {
      queueMicrotask(() => this.start()); // the picture to begin with was overtaken, or not asked for
      return;
    }
    this.base ??= this.now;
    if (!this.changed.length) this.judge();
    this.tell();
  }

  judge() {
    const reached = this.reached[this.lesson.name];
    this.lesson.goals.forEach(({ met }, i) => (reached[i] ||= met(this.now, this.base)));
    this.keep();
  }

  /** Names of what the task keeps, and has been changed. */
  get changed() {
    const kept = [...Object.keys(this.units), "law", "friction_form"].filter((name) => !this.lesson.free.includes(name));
    return kept.filter((name) => !near(this.now.values[name], this.base.values[name], 0.02));
  }

  isDone({ name }) {
    return this.reached[name].every(Boolean);
  }

  tell() {
    const { lesson, base, now, index } = this;
    this.strip.tell({
      index,
      lesson,
      isBegun: Boolean(base),
      isDone: this.isDone(lesson),
      done: LESSONS.map((each) => this.isDone(each)),
      reached: this.reached[lesson.name],
      measure: base && !this.changed.length ? lesson.measure(now) : "",
      note: base ? this.note() : "",
    });
  }

  /** What is to be said of where the task stands. */
  note() {
    const { changed, base, now, lesson } = this;
    if (!changed.length) return lesson.astray(now, base);
    const name = changed[0];
    const before = name in this.units ? shown(base.values[name], this.units[name]) : base.values[name];
    return `This task does not allow a change of ${name}. Set it back to ${before}, or reset the sliders.`;
  }

  keep() {
    const { index, reached } = this;
    keep(KEY, { index, reached });
  }
}

/** A picture's values and numbers as numbers. */
function momentOf({ values, numbers, arrays }) {
  const asNumbers = (row) => Object.fromEntries(Object.entries(row).map(([name, value]) => [name, ["Infinity", "-Infinity", "NaN"].includes(value) ? number(value) : value]));
  return { values: asNumbers(values), numbers: asNumbers(numbers), arrays, regime: numbers.regime };
}

const noneReached = () => Object.fromEntries(LESSONS.map(({ name, goals }) => [name, goals.map(() => false)]));

/** The progress that the browser has kept, if it is of these tasks. */
function recalled() {
  const { index, reached } = recall(KEY) ?? {};
  const fits = index in LESSONS && LESSONS.every(({ name, goals }) => reached?.[name]?.length === goals.length);
  return fits ? { index, reached } : { index: 0, reached: noneReached() };
}
