// The server's plain text with symbols as mathematics; also the symbols of fields and tables.

import { element } from "./dom.js";
import { superscript } from "./numbers.js";

const SYMBOLS = {
  "b - a": [["i", "b"], ["", " \u2212 "], ["i", "a"]],
  "tau/sigma": [["i", "\u03c4"], ["", "/"], ["i", "\u03c3"]],
  "K/K_c_qs": [["i", "K"], ["", "/"], ["i", "K"], ["sub", "c,qs"]],
  "K/K_c": [["i", "K"], ["", "/"], ["i", "K"], ["sub", "c"]],
  K_c_qs: [["i", "K"], ["sub", "c,qs"]],
  K_c: [["i", "K"], ["sub", "c"]],
  K_fold: [["i", "K"], ["sub", "fold"]],
  V_c: [["i", "V"], ["sub", "c"]],
  V_c_upper: [["i", "V"], ["sub", "c,upper"]],
  V_lp: [["i", "V"], ["sub", "lp"]],
  V0: [["i", "V"], ["sub", "0"]],
  V_from: [["i", "V"], ["sub", "lp"]],
  sigma_from: [["i", "\u03c3"]],
  V_max: [["i", "V"], ["sub", "max"]],
  V_min: [["i", "V"], ["sub", "min"]],
  Dc: [["i", "D"], ["sub", "c"]],
  mu0: [["i", "\u03bc"], ["sub", "0"]],
  mu: [["i", "\u03bc"]],
  f_n: [["i", "f"], ["sub", "n"]],
  sigma: [["i", "\u03c3"]],
  eta: [["i", "\u03b7"]],
  alpha: [["i", "\u03b1"]],
  a: [["i", "a"]],
  b: [["i", "b"]],
  K: [["i", "K"]],
  M: [["i", "M"]],
  M_c: [["i", "M"], ["sub", "c"]],
  V: [["i", "V"]],
  f: [["i", "f"]],
};
const NAMES = Object.keys(SYMBOLS).filter((name) => !["a", "f"].includes(name));
const PATTERN = new RegExp(`(?<![\\w/'"])(${NAMES.join("|")})(?![\\w/'"^])`);

// A symbol of a law's own: that of another quantity or a letter, and what is below the line.
const OWN = new RegExp(`^(${Object.keys(SYMBOLS).filter((name) => /^\w+$/.test(name)).sort((a, b) => b.length - a.length).join("|")}|[A-Za-z])(?:_(\\w+)|(\\d+))?$`);
const own = new Set();

/** Take the symbols of the laws' own parameters. */
export function learnSymbols(names) {
  for (const name of names) own.add(name);
}

/** A symbol as [[tag, text], ...]; of what is no known symbol, its own letters. */
export function parts(name) {
  if (Object.hasOwn(SYMBOLS, name)) return SYMBOLS[name];
  const found = own.has(name) && name.match(OWN);
  if (!found) return [["", name]];
  const known = SYMBOLS[found[1]] ?? [["i", found[1]]];
  const below = found[2] ?? found[3];
  return below ? [...known, ["sub", below]] : known;
}

/** The same as nodes. */
export function symbol(name) {
  return parts(name).map(([tag, text]) => (tag ? element(tag, {}, text) : document.createTextNode(text)));
}

/** The same as an element that is explained where it is pointed at; of a term, with these words. */
export function explained(name, ...words) {
  const node = element("span", {}, ...(words.length ? words : symbol(name)));
  node.dataset.meaning = name;
  return node;
}

/** Put a sentence into an element. */
export function write(into, text) {
  // between the texts of a split stand what its pattern holds
  into.replaceChildren(...text.split(PATTERN).flatMap((part, i) => (i % 2 ? [explained(part)] : [units(part)])));
}

function units(text) {
  const shown = text
    .replace(/(\d) u(m|s|Hz)/g, "$1 \u00b5$2")
    .replaceAll("kg/m^2", "kg/m\u00b2")
    .replaceAll("<=", "\u2264")
    .replaceAll("->", "\u2192")
    .replaceAll("+-", "\u00b1")
    .replace(/(\d)e([+-]?)0*(\d+)/g, (_, digit, sign, power) => `${digit}\u00b710${superscript((sign === "-" ? "-" : "") + power)}`)
    .replace(/(\d) (?=\S)/g, "$1\u00a0");
  return document.createTextNode(shown);
}
