// The list of an experiment: what there was before time 0, the segments from then on, and the conditions in the end.

import { element } from "../common/dom.js";
import { ascii, display } from "../common/numbers.js";
import { sigmaVaries } from "./protocol.js";
import { symbol } from "../common/words.js";

const NAMES = { V: "speed", sigma: "normal stress", duration: "duration" };

export class ProtocolList {
  /** table: to be filled; take, takeRows: functions (texts or rows, event's time stamp), called when they are edited */
  constructor(table, take, takeRows) {
    Object.assign(this, { table, take, takeRows, shape: "" });
    this.inputs = {}; // "V of segment 2", V_from, ... -> input
  }

  /** Show an experiment; elements stay where none comes or goes, so that the focus does. */
  show(texts, rows) {
    Object.assign(this, { texts, rows });
    const varies = sigmaVaries(texts, rows);
    const shape = [varies, Boolean(texts.kick), this.rows.length].join();
    if (shape !== this.shape) this.build(varies);
    this.shape = shape;
    this.fill("V_from", texts.V_from, texts.V_lp);
    this.fill("sigma_from", texts.sigma_from, texts.sigma);
    this.fill("kick", texts.kick);
    let sigma = texts.sigma_from ?? texts.sigma; // where a row has none it stays as it was
    this.rows.forEach((row, i) => {
      for (const column of Object.keys(NAMES)) this.fill(`${column} of segment ${i + 1}`, row[column], column === "sigma" ? sigma : "");
      sigma = row.sigma || sigma;
    });
    this.last.forEach(([cell, name]) => (cell.textContent = display(texts[name] ?? "")));
  }

  fill(name, text = "", otherwise = "") {
    const input = this.inputs[name];
    if (!input) return;
    input.value = display(text);
    input.placeholder = display(otherwise);
  }

  build(varies) {
    this.inputs = {};
    const columns = Object.keys(NAMES).filter((column) => varies || column !== "sigma");
    const head = columns.map((column) => element("th", { scope: "col" }, ...(column === "duration" ? ["for"] : symbol(column))));
    this.last = [];
    const ending = (name) => {
      const cell = element("td", {});
      this.last.push([cell, name]);
      return cell;
    };
    this.table.replaceChildren(
      element("thead", {}, element("tr", {}, element("td", {}), ...head, element("td", {}))),
      element("tbody", {}, this.before(varies), ...this.kick(columns.length), ...this.rows.map((_, i) => this.segment(i, columns)), line("then", ending("V_lp"), ...(varies ? [ending("sigma")] : []), element("td", { colSpan: 2 }, "on"))),
    );
  }

  before(varies) {
    const input = (name, label) => element("td", {}, this.input(name, label, (text, stamp) => this.take({ [name]: text || null }, stamp)));
    const stress = varies ? [input("sigma_from", "normal stress before time 0")] : [];
    return line("before", input("V_from", "speed before time 0"), ...stress, element("td", { colSpan: 2 }, "settled"));
  }

  kick(columns) {
    if (!this.texts.kick) return [];
    const input = this.input("kick", "factor of the slip velocity at time 0", (text, stamp) => this.take({ kick: text || null }, stamp));
    const what = element("td", { colSpan: columns - 1, className: "factor" }, "\u00d7 ", ...symbol("V"));
    return [line("kick", element("td", {}, input), what, this.remover("the kick", (stamp) => this.take({ kick: null }, stamp)))];
  }

  segment(i, columns) {
    const cells = columns.map((column) => {
      const label = `${NAMES[column]} of segment ${i + 1}`;
      return element("td", {}, this.input(`${column} of segment ${i + 1}`, label, (text, stamp) => this.edit(i, { [column]: text }, stamp)));
    });
    return line(String(i + 1), ...cells, this.remover(`segment ${i + 1}`, (stamp) => this.remove(i, stamp)));
  }

  input(name, label, change) {
    const input = element("input", { type: "text", spellcheck: false });
    input.setAttribute("aria-label", label);
    input.setAttribute("aria-describedby", `problem-${name.includes(" ") ? "protocol" : name}`);
    input.addEventListener("change", (event) => change(ascii(input.value.trim()), event.timeStamp));
    this.inputs[name] = input;
    return input;
  }

  remover(what, act) {
    const button = element("button", { type: "button", className: "quiet", textContent: "\u00d7" });
    button.setAttribute("aria-label", `Remove ${what}`);
    button.addEventListener("click", (event) => act(event.timeStamp));
    return element("td", {}, button);
  }

  edit(i, changed, stamp) {
    this.takeRows(this.rows.map((row, k) => (k === i ? { ...row, ...changed } : row)), stamp);
  }

  remove(i, stamp) {
    this.takeRows(this.rows.filter((_, k) => k !== i), stamp);
    this.focus(Math.min(i, this.rows.length - 1));
  }

  /** Go to the speed of a segment, by default the last; of none, to that before. */
  focus(i = this.rows.length - 1) {
    this.inputs[i < 0 ? "V_from" : `V of segment ${i + 1}`].focus();
  }

  /** Mark what a message about an entry names, or nothing. */
  mark(name, text) {
    const named = name === "protocol" ? [...text.matchAll(/((?:V|sigma|duration) of )?segment (\d+)/g)] : [];
    const parts = named.flatMap(([, what, i]) => (what ? [what] : Object.keys(NAMES).map((column) => `${column} of `)).map((of) => `${of}segment ${i}`));
    for (const [known, input] of Object.entries(this.inputs)) {
      if (known === name || (name === "protocol" && known.includes(" "))) {
        input.setAttribute("aria-invalid", (known === name ? text : parts.includes(known)) ? "true" : "false");
      }
    }
  }
}

function line(name, ...cells) {
  return element("tr", {}, element("th", { scope: "row", textContent: name }), ...cells);
}
