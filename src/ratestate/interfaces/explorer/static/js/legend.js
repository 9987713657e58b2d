// What the map's colours and marks mean: of those that occur.

import { element } from "./dom.js";

/** regimes in the order of their codes: name, colour role */
export const REGIMES = [
  ["steady sliding", "steady"],
  ["slow stick-slip", "slow"],
  ["stick-slip", "stick"],
  ["quasi-harmonic", "harmonic"],
  ["not known", "unknown"],
];

export class Legend {
  /** list: element */
  constructor(list) {
    this.list = list;
    this.regimes = REGIMES.map(([name, role]) => this.entry(`patch ${role}`, name));
    this.jump = this.entry("line jump", "lost with a jump");
    this.size = this.entry("", "");
    this.beyond = this.entry("point beyond", "the slider is beyond the map");
  }

  entry(mark, text) {
    const item = element("li", { hidden: true }, element("span", { className: mark }), text);
    this.list.append(item);
    return item;
  }

  /** What occurs in this atlas; null while it is not known. */
  tell(chart) {
    this.list.classList.toggle("waiting", !chart);
    if (!chart) return;
    const { size, arrays } = chart;
    this.regimes.forEach((item, code) => (item.hidden = !arrays.regime.includes(code)));
    this.jump.hidden = !arrays.jumps.includes(1);
    this.size.hidden = false;
    this.size.textContent = `coarse: ${size} \u00d7 ${size} sliders`;
  }

  /** Nothing occurs. */
  clear() {
    this.list.classList.remove("waiting");
    for (const item of [...this.regimes, this.jump, this.size]) item.hidden = true;
  }

  /** Whether the slider is beyond the map. */
  place(beyond) {
    this.beyond.hidden = !beyond;
  }
}
