// What the page shows, as texts: kept here, and in the address, so that a link holds it all.

import { Past } from "./past.js";

export class Entries {
  /**
   * names: of what there always is; experiment: of what there need not be, as friction, and is not in place of a wrong one
   * valid: texts that can be used, of names
   * longest: characters that one may have, by name; of any other that of "value"
   * live: of a saved page, whose own address holds nothing, the address of the page that it was
   */
  constructor(names, experiment, valid, longest, live) {
    this.absent = Object.fromEntries(["friction_form", ...experiment].map((name) => [name, null]));
    this.names = [...names, "friction_form", ...experiment];
    Object.assign(this, { experiment, valid: { ...valid, ...this.absent }, longest, live, texts: {}, refused: {} });
    this.past = new Past(live ? null : () => this.fragment());
  }

  /**
   * What is asked for: the texts, and in place of those known to be wrong the last valid ones.
   * Of one that is too long, as much as shows that it is.
   */
  asked() {
    for (const [name, { text }] of Object.entries(this.refused)) if (this.texts[name] !== text) delete this.refused[name];
    const asked = Object.fromEntries(Object.entries(this.texts).map(([name, text]) => [name, text.slice(0, (this.longest[name] ?? this.longest.value) + 1)]));
    for (const name of Object.keys(this.refused)) asked[name] = this.valid[name];
    return asked;
  }

  /** The server can use what was asked for. */
  accept() {
    this.valid = { ...this.valid, ...this.asked(), ...this.absent };
  }

  /** The server cannot use these: name -> why; whether that is new. */
  refuse(problems) {
    const found = Object.entries(problems).filter(([name]) => this.names.includes(name) && !(name in this.refused));
    for (const [name, why] of found) this.refused[name] = { text: this.texts[name], why };
    return found.length > 0;
  }

  /** Names of what is wrong. */
  get wrong() {
    return Object.keys(this.refused);
  }

  /** Take new texts; those not named stay. */
  set(texts) {
    Object.assign(this.texts, texts);
    for (const name of Object.keys(this.texts)) if (this.texts[name] == null) delete this.texts[name];
    this.past.keep();
  }

  fragment() {
    const known = this.names.filter((name) => name in this.texts);
    return new URLSearchParams(known.map((name) => [name, this.texts[name]])).toString();
  }

  link() {
    return this.live ?? `${location.origin}${location.pathname}#${this.fragment()}`;
  }

  /** The texts that the address holds, of names that are known; null if it holds none. */
  linked() {
    if (this.live) return null;
    const given = [...new URLSearchParams(location.hash.slice(1))].filter(([name]) => this.names.includes(name));
    return given.length ? { ...this.absent, ...Object.fromEntries(given) } : null;
  }
}
