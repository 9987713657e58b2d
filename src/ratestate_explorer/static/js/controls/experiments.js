// Experiments on the motion as it is now: buttons, and the list of what they have made, which can be edited.

import { $, explainBeside } from "../common/dom.js";
import { ascii, display, entry, factor } from "../common/numbers.js";
import { rowOf, rowsOf, sigmaVaries, textOf } from "./protocol.js";
import { ProtocolList } from "./protocol_list.js";
import { number } from "../common/wire.js";

export class Experiments {
  /**
   * before: name of an entry -> of what it is the value before time 0; controls: Controls, whose texts they change
   * askHolds: function (hold, act) that has the server make the rows of a slide-hold-slide test, and acts with them
   */
  constructor(before, controls, askHolds) {
    Object.assign(this, { before, controls, askHolds, entries: controls.entries });
    this.rows = []; // of the protocol, whose text is `written`
    this.written = null;
    this.none = { ...Object.fromEntries(Object.keys(before).map((name) => [name, null])), protocol: null, kick: null };
    this.list = new ProtocolList($("protocol"), (texts, stamp) => controls.take(texts, stamp), (rows, stamp) => this.takeRows(rows, {}, stamp));
    this.listen();
  }

  listen() {
    const acts = { hold: this.hold, "slide-hold-slide": this.slideHoldSlide, kick: this.kick, unstep: this.unstep, clear: this.clear, "add-segment": this.add };
    for (const [id, act] of Object.entries(acts)) this.onClick(id, (event) => act.call(this, event));
    for (const [name, of] of Object.entries(this.before)) this.onClick(`step-${of}`, (event) => this.step(name, of, event));
  }

  /** The second click of a double one does nothing. */
  onClick(id, act) {
    $(id).addEventListener("click", (event) => event.detail < 2 && this.controls.whenRead(() => act(event)));
  }

  get texts() {
    return this.entries.texts;
  }

  /** Show what the texts are. */
  show() {
    const { texts } = this;
    $("experiment").hidden = !Object.keys(this.none).some((name) => texts[name]);
    $("stepped").hidden = Boolean(texts.protocol || texts.kick);
    const steps = Object.entries(this.before).filter(([name]) => texts[name]);
    const said = steps.map(([name, of]) => `${display(texts[name])} to ${display(texts[of])}`);
    $("stepped").querySelector("span").textContent = `Stepped from ${said.join(", and from ")} at time 0.`;
    if (!texts.protocol) this.learn([]);
    this.list.show(texts, this.rows);
  }

  /** The rows of the protocol that is shown; of a link the server tells them. */
  learn(sent) {
    this.rows = rowsOf(sent);
    this.written = this.texts.protocol ?? null;
  }

  /** Take these rows as the protocol, beside other texts. */
  takeRows(rows, texts, stamp) {
    this.rows = rows;
    this.written = textOf(rows);
    this.controls.take({ ...texts, protocol: this.written }, stamp);
  }

  /** The server reads these values; settling: seconds for which the last part is shown. */
  accept(values, settling) {
    this.values = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, number(value)]));
    this.settling = settling ?? this.settling;
  }

  /** Say what is wrong with one of its entries. */
  explain(name, text) {
    explainBeside(name, text);
    this.list.mark(name, text);
  }

  /** The rows of what there is so far, the conditions as they are now the last of them. */
  get soFar() {
    const { rows } = this;
    return $("experiment").hidden ? rows : [...rows, rowOf(this.values, this.settling, sigmaVaries(this.texts, rows))];
  }

  /** What is wrong with what these act on: the value of such a field, or the experiment so far; "" if nothing. */
  wrong(of) {
    const name = [of, ...Object.keys(this.none)].find((known) => known in this.entries.refused);
    return name ? `correct ${name} first` : "";
  }

  /** Whether a button can do its work; says beside it why not. */
  isReady(place, problem, of = "V_lp") {
    const why = problem || this.wrong(of);
    explainBeside(place, why);
    return !why && this.values !== undefined;
  }

  /** The factor typed beside a button, and what is wrong with it. */
  factorOf(id) {
    const text = $(id).value;
    const times = factor(text);
    const usable = times > 0 && times !== 1 && Number.isFinite(times);
    return [times, usable ? "" : `factor = '${text}' cannot be used. Give a number > 0 that is not 1, such as 3 or 1/3.`];
  }

  /** Step the speed of the load point or the normal stress from what it is. */
  step(name, of, event) {
    const [times, problem] = this.factorOf(`factor-${of}`);
    if (!this.isReady(`factor-${of}`, problem, of)) return;
    const unit = of === "V_lp" ? "m/s" : "Pa";
    const now = entry(this.values[of], unit, 6);
    this.takeRows(this.soFar, { [name]: this.texts[name] ?? now, [of]: entry(times * this.values[of], unit, 6) }, event.timeStamp);
  }

  /** Step as a record does: its speeds [m/s] before and after, its normal stress [Pa]; null of what it has not. */
  takeConditions({ V_from, V_lp, sigma }) {
    const found = { V_from: [V_from, "m/s"], V_lp: [V_lp, "m/s"], sigma: [sigma, "Pa"] };
    const texts = Object.entries(found).filter(([, [value]]) => value !== null).map(([name, of]) => [name, entry(...of)]);
    this.controls.take({ ...this.none, ...Object.fromEntries(texts) });
  }

  hold(event) {
    if (!this.isReady("hold-time", "")) return;
    this.takeRows([...this.soFar, { V: "0 m/s", sigma: "", duration: this.holdTime }], {}, event.timeStamp);
  }

  slideHoldSlide(event) {
    if (!this.isReady("hold-time", "")) return;
    const { timeStamp } = event;
    this.askHolds(this.holdTime, (sent) => this.takeRows([...this.soFar, ...rowsOf(sent)], {}, timeStamp));
  }

  get holdTime() {
    return ascii($("hold-time").value.trim());
  }

  /** Kick the motion as it is now; that before a protocol, where there is one. */
  kick(event) {
    const [times, problem] = this.factorOf("factor-kick");
    if (!this.isReady("factor-kick", problem)) return;
    const kick = entry(times, "1", 6);
    this.controls.take(this.texts.protocol ? { kick } : { ...this.none, kick }, event.timeStamp);
  }

  /** Go on with the conditions as they are now, as a segment to be edited. */
  add(event) {
    if (this.wrong("V_lp") || !this.values) return; // said of it
    this.takeRows(this.soFar, {}, event.timeStamp);
    this.list.focus();
  }

  clear(event) {
    this.controls.take(this.none, event.timeStamp);
    $("step-V_lp").focus();
  }

  /** Back to what there was before the step. */
  unstep(event) {
    const stepped = Object.entries(this.before).filter(([name]) => this.texts[name]);
    if (!stepped.length) return;
    const earlier = Object.fromEntries(stepped.map(([name, of]) => [of, this.texts[name]]));
    this.controls.take({ ...earlier, ...this.none }, event.timeStamp);
    $(`step-${stepped[0][1]}`).focus();
  }
}
