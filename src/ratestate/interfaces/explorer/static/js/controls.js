// Everything that is set by hand: fields, law, preset, velocity step; and what is wrong with it.

import { $ } from "./dom.js";
import { Field } from "./fields.js";
import { entry, shown } from "./numbers.js";
import { number } from "./wire.js";
import { learnSymbols } from "./words.js";

const REFERENCE = ["mu0", "V0"];

export class Controls {
  /**
   * entries: Entries; ask: function (event's time stamp), called when they have changed;
   * whenRead: function (act) that acts once the server has read all that was typed
   */
  constructor(specs, laws, presets, entries, ask, whenRead) {
    Object.assign(this, { presets, entries, ask, whenRead, fields: {} });
    this.ofLaw = Object.fromEntries(laws.flatMap(({ names, parameters }) => names.map((name) => [name, parameters])));
    this.own = new Set(laws.flatMap(({ parameters }) => parameters));
    this.texts = {}; // of the laws' own parameters, those of laws that are not shown too
    learnSymbols(this.own);
    for (const spec of specs) {
      const field = new Field(spec, (name, text, stamp) => this.change({ [name]: text }, stamp));
      this.fields[spec.symbol] = field;
      $(REFERENCE.includes(spec.symbol) ? "reference" : this.own.has(spec.symbol) ? "own" : "fields").append(field.element);
      if (this.own.has(spec.symbol)) this.texts[spec.symbol] = spec.text;
    }
    for (const { name, label } of laws) $("law").add(new Option(label, name));
    presets.forEach(({ title }, i) => $("presets").add(new Option(title, i)));
    this.listen();
    const linked = entries.linked();
    this.show({ ...presets[0].entries, ...linked });
    if (!linked) $("presets").value = 0;
  }

  listen() {
    $("presets").addEventListener("change", (event) => {
      const chosen = this.presets[event.target.value];
      if (chosen) this.take({ V_from: null, ...chosen.entries }, event.timeStamp);
    });
    $("law").addEventListener("change", (event) => {
      $("presets").value = "";
      this.take({ law: event.target.value }, event.timeStamp);
    });
    // The second click of a double one is no second step.
    $("step").addEventListener("click", (event) => event.detail < 2 && this.whenRead(() => this.step(event)));
    $("unstep").addEventListener("click", (event) => this.whenRead(() => this.unstep(event)));
    $("controls").addEventListener("submit", (event) => event.preventDefault());
    addEventListener("hashchange", () => {
      const linked = this.entries.linked();
      if (!linked) return;
      this.take({ V_from: null, ...linked });
      $("presets").value = "";
    });
  }

  /** Take texts from a field that shows them. */
  change(texts, stamp) {
    this.entries.set(texts);
    $("presets").value = "";
    this.ask(stamp);
  }

  /** Take texts that come from no field: show them, and ask. */
  take(texts, stamp) {
    this.show(texts);
    this.ask(stamp);
  }

  show(texts) {
    this.entries.set(this.withOwn(texts));
    for (const [name, field] of Object.entries(this.fields)) {
      field.show(this.entries.texts[name] ?? "");
      field.element.hidden = !(name in this.entries.texts) && this.own.has(name);
    }
    $("law").value = this.entries.texts.law;
  }

  /** These texts, with those of the law's own parameters, and without those of other laws'. */
  withOwn(texts) {
    const law = texts.law ?? this.entries.texts.law;
    for (const name of this.own) this.texts[name] = texts[name] ?? this.entries.texts[name] ?? this.texts[name];
    const own = [...this.own].map((name) => [name, this.ofLaw[law]?.includes(name) ? this.texts[name] : null]);
    return { ...texts, ...Object.fromEntries(own) };
  }

  /** Step the load point's speed from where it is. */
  step(event) {
    const factor = Number($("factor").value);
    const usable = factor > 0 && factor !== 1 && Number.isFinite(factor);
    const wrong = usable ? "correct V_lp first" : `factor = '${$("factor").value}' is no use; expected a number > 0 that is not 1, such as 3 or 0.1`;
    const ready = usable && !("V_lp" in this.entries.refused);
    this.explain("V_from", ready ? "" : wrong);
    if (!ready || !this.values) return;
    const V = this.values.V_lp;
    this.take({ V_from: entry(V, "m/s", 6), V_lp: entry(factor * V, "m/s", 6) }, event.timeStamp);
    $("presets").value = "";
  }

  /** Back to the speed before the step. */
  unstep(event) {
    if (!this.entries.texts.V_from) return;
    this.take({ V_lp: this.entries.texts.V_from, V_from: null }, event.timeStamp);
    $("step").focus();
  }

  /** Put the slider onto another point of the map: K, and either V_lp or M. */
  move(ratio, eta, { values, numbers }, stamp) {
    const texts = { K: entry(ratio * numbers.K_c_qs, "Pa/m") };
    if (numbers.eta > 0) {
      const more = eta / numbers.eta;
      const sets = document.querySelector("[name=drag]:checked").value;
      const value = values[sets] * (sets === "M" ? more : Math.sqrt(more));
      texts[sets] = entry(value, this.fields[sets].spec.unit);
    }
    $("presets").value = "";
    this.take(texts, stamp);
  }

  /** The server reads these values from what was asked for. */
  accept(values) {
    this.values = values;
    this.entries.accept();
    this.explainAll();
    if (values.law !== this.entries.texts.law && !("law" in this.entries.refused)) this.show({ law: values.law });
    for (const [name, field] of Object.entries(this.fields)) {
      if (!(name in values)) continue;
      field.place(number(values[name]));
      if (!(name in this.entries.refused)) this.rename(name, field.complete());
    }
    const { V_from, V_lp } = values;
    $("stepped").hidden = V_from === null;
    if (V_from === null) return;
    const told = `Stepped from ${shown(V_from, "m/s")} to ${shown(V_lp, "m/s")} at time 0.`;
    $("stepped").querySelector("span").textContent = told;
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
    if (name in this.fields) {
      this.fields[name].explain(text);
      return;
    }
    const message = { law: $("law-problem"), V_from: $("factor-problem") }[name];
    message.textContent = text;
    message.hidden = !text;
  }
}
