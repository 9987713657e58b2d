// Everything that is set by hand: fields, law, friction, preset, experiments; and what is wrong with it.

import { $, explainBeside } from "../common/dom.js";
import { Experiments } from "./experiments.js";
import { Field } from "./fields.js";
import { entry } from "../common/numbers.js";
import { number } from "../common/wire.js";
import { learnSymbols } from "../common/words.js";

const REFERENCE = ["mu0", "V0"];

export class Controls {
  /**
   * before: name of an entry of experiments -> of what it is the value before time 0;
   * entries: Entries; ask: function (event's time stamp), called when they have changed;
   * whenRead: function (act) that acts once the server has read all that was typed; askHolds: as of `Experiments`
   */
  constructor(specs, laws, before, presets, entries, ask, whenRead, askHolds) {
    Object.assign(this, { presets, entries, ask, whenRead, fields: {} });
    this.forms = Object.fromEntries(laws.flatMap(({ names, forms }) => names.map((name) => [name, forms])));
    this.own = new Set(laws.flatMap(({ forms }) => Object.values(forms).flat()));
    this.texts = {}; // of what only some laws and forms of friction have, those that are not shown too
    learnSymbols(this.own);
    for (const spec of specs) {
      const field = new Field(spec, (name, text, stamp) => this.change({ [name]: text }, stamp));
      this.fields[spec.symbol] = field;
      $(REFERENCE.includes(spec.symbol) ? "reference" : this.own.has(spec.symbol) ? "own" : "fields").append(field.element);
      if (this.own.has(spec.symbol)) this.texts[spec.symbol] = spec.text;
    }
    for (const { name, label } of laws) $("law").add(new Option(label, name));
    for (const form of new Set(laws.flatMap(({ forms }) => Object.keys(forms)))) $("friction_form").add(new Option(form));
    presets.forEach(({ title }, i) => $("presets").add(new Option(title, i)));
    this.experiments = new Experiments(before, this, askHolds);
    this.listen();
    const linked = entries.linked();
    this.show({ ...presets[0].entries, ...linked });
    this.entries.past.write(); // the state to which undo leads back
  }

  listen() {
    $("presets").addEventListener("change", (event) => {
      const chosen = this.presets[event.target.value];
      if (chosen) this.begin(chosen.entries, event.timeStamp);
    });
    for (const name of ["law", "friction_form"]) {
      $(name).addEventListener("change", (event) => {
        this.take({ [name]: event.target.value }, event.timeStamp);
      });
    }
    $("controls").addEventListener("submit", (event) => event.preventDefault());
    addEventListener("hashchange", () => {
      if (this.fixed) return;
      const linked = this.entries.linked();
      this.entries.past.moved();
      if (!linked) return;
      this.show(linked);
      this.ask();
    });
  }

  /** Nothing can be changed in a saved page. */
  get fixed() {
    return Boolean(this.entries.live);
  }

  /** Take texts from a field that shows them. */
  change(texts, stamp) {
    if (this.fixed) return;
    this.entries.set(texts);
    this.entries.past.add();
    this.experiments.show();
    this.tellPreset();
    this.ask(stamp);
  }

  /** Take texts that come from no field: show them, and ask. */
  take(texts, stamp) {
    if (this.fixed) return;
    this.show(texts);
    this.entries.past.add();
    this.ask(stamp);
  }

  /** Begin with these texts and no others: sliders reach about what they are. */
  begin(texts, stamp) {
    for (const field of Object.values(this.fields)) field.range.renew();
    this.take({ ...this.entries.absent, ...texts }, stamp);
  }

  show(texts) {
    this.entries.set(this.withOwn(texts));
    for (const [name, field] of Object.entries(this.fields)) {
      field.show(this.entries.texts[name] ?? "");
      field.element.hidden = !(name in this.entries.texts) && this.own.has(name);
    }
    this.experiments.show();
    const { law, friction_form } = this.entries.texts;
    $("law").value = law;
    for (const option of $("friction_form").options) option.disabled = !(option.value in (this.forms[law] ?? {}));
    $("friction_form").value = friction_form ?? this.formOf(law);
    this.tellPreset();
  }

  /** Name the preset that is shown, if it is one. */
  tellPreset() {
    const { texts, absent } = this.entries;
    const all = (entries) => Object.entries({ ...absent, ...entries }).every(([name, text]) => (texts[name] ?? null) === text);
    const found = this.presets.findIndex(({ entries }) => all(entries));
    $("presets").value = found < 0 ? "" : found;
  }

  /** The form of friction that a law is for. */
  formOf(law) {
    return Object.keys(this.forms[law] ?? {})[0];
  }

  /**
   * These texts, with those that the law with its friction has alone, and without those of others;
   * another law without a form of friction keeps that which is shown, if it goes with it.
   */
  withOwn(texts) {
    const { law, friction_form } = { ...this.entries.texts, ...texts };
    const forms = this.forms[law] ?? {};
    const form = friction_form in forms ? friction_form : this.formOf(law);
    for (const name of this.own) this.texts[name] = texts[name] ?? this.entries.texts[name] ?? this.texts[name];
    const own = [...this.own].map((name) => [name, forms[form]?.includes(name) ? this.texts[name] : null]);
    return { ...texts, ...("law" in texts ? { friction_form: texts.friction_form ?? form } : {}), ...Object.fromEntries(own) };
  }

  /** Put the slider onto another point of the map: K, and either V_lp or M. */
  move(ratio, eta, digits, { values, numbers }, stamp) {
    const texts = { K: entry(ratio * numbers.K_c_qs, "Pa/m", digits) };
    if (numbers.eta > 0) {
      const more = eta / numbers.eta;
      const sets = document.querySelector("[name=drag]:checked").value;
      const value = values[sets] * (sets === "M" ? more : Math.sqrt(more));
      texts[sets] = entry(value, this.fields[sets].spec.unit, digits);
    }
    this.take(texts, stamp);
  }

  /** Set one parameter, in SI. */
  set(name, value, stamp) {
    this.take({ [name]: entry(value, this.fields[name].spec.unit) }, stamp);
  }

  /**
   * The server reads these values from what was asked for; settling: see `Experiments.accept`
   * texts, protocol: how the server writes what was asked for, and the rows of its protocol; none with a problem
   */
  accept({ values, settling, texts, protocol }) {
    this.entries.accept();
    this.explainAll();
    if (texts) this.completeExperiment(texts, protocol);
    for (const name of ["law", "friction_form"]) {
      if (values[name] !== this.entries.texts[name] && !(name in this.entries.refused)) this.show({ [name]: values[name] });
    }
    for (const [name, field] of Object.entries(this.fields)) {
      if (!(name in values)) continue;
      field.place(number(values[name]));
      if (!(name in this.entries.refused)) this.rename(name, field.complete(texts?.[name]));
    }
    this.experiments.accept(values, settling);
  }

  /** Show an experiment as the server writes it. */
  completeExperiment(texts, protocol) {
    const { experiments, entries } = this;
    const names = Object.keys(experiments.none).filter((name) => name in entries.texts && name in texts && !(name in entries.refused));
    const changed = names.filter((name) => entries.texts[name] !== texts[name]);
    if (!changed.length && experiments.written === (entries.texts.protocol ?? null)) return;
    entries.set(Object.fromEntries(changed.map((name) => [name, texts[name]])));
    if (names.includes("protocol")) experiments.learn(protocol);
    experiments.show();
  }

  /** Show the rows of a protocol that is wrong. */
  learnRows(protocol) {
    if (this.experiments.written === this.entries.texts.protocol) return;
    this.experiments.learn(protocol);
    this.experiments.show();
  }

  /** Mark the critical values of a picture on their sliders. */
  mark({ marks }) {
    for (const [name, critical] of Object.entries(marks)) this.fields[name].mark(critical);
  }

  /** Take the same value in other words. */
  rename(name, text) {
    if (text !== this.entries.texts[name]) this.entries.set({ [name]: text });
    this.entries.valid[name] = text;
  }

  /** Say what is wrong now beside each control, and nothing beside the others. */
  explainAll() {
    for (const name of this.entries.names) this.explain(name, this.entries.refused[name]?.why ?? "");
  }

  /** Say what is wrong beside the control that it is about. */
  explain(name, text) {
    if (name in this.fields) this.fields[name].explain(text);
    else if (name in this.experiments.none) this.experiments.explain(name, text);
    else explainBeside(name, text);
  }
}
