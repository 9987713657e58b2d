// What the slider does, in words and numbers.

import { element } from "../common/dom.js";
import { number } from "../common/wire.js";
import { plain, shown } from "../common/numbers.js";
import { Roving } from "../common/roving.js";
import { explained, symbol, write } from "../common/words.js";

export function tell(picture, elements) {
  const [first, ...rest] = picture.sentences;
  write(elements.headline, first);
  write(elements.reasons, rest.join(" "));
  write(elements.notes, picture.notes.join(" "));
  elements.notes.hidden = !picture.notes.length;
  const table = rows(picture);
  if (!elements.numbers.children.length) {
    elements.numbers.append(...table.map(row));
    new Roving(elements.numbers, "[data-meaning]").refresh();
  }
  table.forEach(([, , text], i) => {
    const value = elements.numbers.children[i].lastChild;
    value.textContent = text;
    value.title = text;
  });
}

function rows({ numbers, values }) {
  const [K_c, V_c] = [number(numbers.K_c), number(numbers.V_c)];
  const cycle = numbers.period !== null;
  const [real, imaginary] = cycle ? numbers.multiplier.map(number) : [];
  return [
    ["K/K_c", ["K/K_c"], K_c > 0 ? plain(number(values.K) / K_c, 4) : "\u2013"],
    ["K_c", ["K_c"], K_c > 0 ? shown(K_c, "Pa/m") : "none"],
    ["eta", ["eta"], plain(numbers.eta)],
    ["V_c", ["V_c"], V_c === 0 ? "0" : V_c === Infinity ? "none" : shown(V_c, "m/s")],
    ["f", ["f"], cycle ? shown(numbers.frequency, "Hz") : "\u2013"],
    ["amplitude", ["amplitude of ", "tau/sigma"], cycle ? plain(numbers.amplitude, 4) : numbers.amplitude === 0 ? "0" : "\u2013"],
    ["V_max", ["fastest slip ", "V_max"], cycle ? shown(numbers.V_max, "m/s", 3) : "\u2013"],
    ["V_min", ["slowest"], cycle ? shown(numbers.V_min, "m/s", 3) : "\u2013"],
    // of a pair of complex ones the size, as in the sentence
    ["Floquet multiplier", ["Floquet multiplier"], !cycle ? "\u2013" : imaginary ? `|${plain(Math.hypot(real, imaginary), 4)}|` : plain(real, 4)],
  ];
}

function row([meaning, names]) {
  return element("div", {}, element("dt", {}, explained(meaning, ...names.flatMap(symbol))), element("dd", {}));
}
