// The panel of the laboratory record: its file, where it lies in time, what is read of it.

import { $, element } from "../common/dom.js";
import { round } from "../common/numbers.js";
import { RecordChoices } from "./record_choices.js";
import { RecordFile } from "./record_file.js";
import { linear } from "../common/ticks.js";
import { write } from "../common/words.js";

const SHIFTS = 100; // shifts by an arrow over the time that is shown
const DIGITS = 8; // of the record's times

export class RecordPanel {
  /**
   * record: LabRecord, a layer of traces; shown: function () that gives the times that these show [s]
   * take: function (conditions) that puts a record's conditions into the fields
   * entries: function () that gives the texts of the fields, from which a fit starts
   */
  constructor(record, shown, take, entries) {
    Object.assign(this, { record, shown, take, entries, found: null });
    this.file = new RecordFile((fraction) => this.progress(fraction));
    this.choices = new RecordChoices(() => this.read());
    this.listen();
  }

  /** Take the server's greeting; a saved page has none that reads files. */
  open(greeting) {
    if (greeting.page && !this.file.page) listenForDrops((files) => this.choose(files));
    this.file.open(greeting);
  }

  listen() {
    const on = (id, kind, act) => $(id).addEventListener(kind, act);
    on("record-open", "click", () => $("record").show());
    on("record-close", "click", () => this.close());
    on("record", "keydown", ({ key }) => key === "Escape" && this.close());
    on("record-choose", "click", () => $("record-file").click());
    on("record-file", "change", ({ target }) => {
      this.choose(target.files);
      target.value = ""; // so that the same file, changed meanwhile, can be chosen again
    });
    on("record-zero", "change", ({ target }) => this.type(target.value));
    on("record-zero", "keydown", (event) => {
      const times = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!times) return;
      event.preventDefault();
      this.shiftBy(times);
    });
    on("record-earlier", "click", () => this.shiftBy(1));
    on("record-later", "click", () => this.shiftBy(-1));
    on("record-whole", "change", ({ target }) => this.record.showWhole(target.checked));
    on("record-conditions", "click", () => this.takeConditions());
    on("record-fit", "click", () => (this.isFitting ? this.stopFit() : this.fit()));
    on("record-remove", "click", () => this.remove());
  }

  close() {
    $("record").close();
    $("record-open").focus();
  }

  // ---- the file

  /** Take the first of some files. */
  choose(files) {
    if (!files.length) return;
    [this.chosen] = files;
    this.choices.clear();
    this.read();
  }

  /** Have the file read as chosen, and fitted from these entries, if any. */
  async read(fit = null) {
    $("record").show();
    this.say(`${fit ? "Fitting" : "Reading"} ${this.chosen.name} \u2026`);
    $("record-notes").replaceChildren();
    this.progress(0);
    this.tellFit(Boolean(fit));
    const found = await this.file.send(this.chosen, { ...this.choices.choices, ...(fit && { fit }) });
    if (!found) return; // for a newer one, or for none
    $("record-progress").hidden = true;
    this.tellFit(false);
    this.choices.offer(found);
    if (found.problem) {
      this.say(found.problem, true);
      if (found.columns.length && !fit) this.choices.show();
      return;
    }
    const { zero } = this.record;
    this.show(found);
    if (fit) this.shift(zero); // a fitted record stays where it lies
  }

  fit() {
    return this.read(this.entries());
  }

  stopFit() {
    this.file.stop();
    $("record-progress").hidden = true;
    this.tellFit(false);
    const { zero } = this.record;
    this.show(this.found);
    this.shift(zero);
  }

  tellFit(isFitting) {
    this.isFitting = isFitting;
    $("record-fit").textContent = isFitting ? "Stop the fit" : "Fit a, b, Dc and K";
  }

  /** So much is sent, of 1; null: all is, and is being read. */
  progress(fraction) {
    const bar = $("record-progress");
    bar.hidden = false;
    if (fraction === null) bar.removeAttribute("value");
    else bar.value = fraction;
  }

  show(found) {
    this.found = found;
    this.record.set(found);
    this.say(found.name);
    $("record-said").append(written("span", `: ${found.found}.`));
    $("record-shown").disabled = false;
    $("record-conditions").disabled = found.conditions.V_lp === null;
    $("record-notes").replaceChildren(...[...found.fitted, ...found.notes].map((note) => written("li", note)));
    this.tellZero();
  }

  remove() {
    this.file.stop();
    this.tellFit(false);
    $("record-progress").hidden = true;
    this.record.set(null);
    this.choices.clear();
    $("record-choices").hidden = true;
    $("record-shown").disabled = true;
    $("record-zero").value = "";
    $("record-notes").replaceChildren();
    this.say("");
    $("record-choose").focus();
  }

  say(text, isProblem = false) {
    $("record-said").textContent = text;
    $("record-said").classList.toggle("problem", isProblem);
  }

  // ---- where it lies

  /** Shift by so many times a hundredth of the time that is shown, rounded. */
  shiftBy(times) {
    const [first, last] = this.shown();
    const [[one], [other]] = linear(0, last - first, SHIFTS);
    this.shift(this.record.zero + times * (other - one));
  }

  shift(zero) {
    this.record.shift(zero);
    this.tellZero();
  }

  type(text) {
    const zero = Number(text);
    const is = text.trim() !== "" && Number.isFinite(zero);
    $("record-zero").ariaInvalid = String(!is);
    if (is) this.record.shift(zero);
  }

  tellZero() {
    $("record-zero").value = round(this.record.zero, DIGITS);
    $("record-zero").ariaInvalid = "false";
  }

  takeConditions() {
    this.shift(this.found.conditions.time);
    this.take(this.found.conditions);
  }
}

/** An element with a sentence of the server. */
function written(tag, sentence) {
  const node = element(tag, {});
  write(node, sentence);
  return node;
}

/** Take files that are dropped anywhere on the page. */
function listenForDrops(take) {
  const holdsFiles = (event) => event.dataTransfer?.types.includes("Files");
  const mark = (is) => document.body.classList.toggle("dropping", is);
  addEventListener("dragover", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    mark(true);
  });
  addEventListener("dragleave", (event) => event.relatedTarget || mark(false));
  addEventListener("drop", (event) => {
    mark(false);
    if (!holdsFiles(event)) return;
    event.preventDefault();
    take(event.dataTransfer.files);
  });
}
