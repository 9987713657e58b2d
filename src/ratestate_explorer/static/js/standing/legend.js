// What the map's colours and marks mean: of those that occur.

import { element } from "../common/dom.js";
import { Roving } from "../common/roving.js";
import { explained } from "../common/words.js";

/** regimes in the order of the legend: as the server names them, as the page does, and the role of their colour */
export const REGIMES = [
  { regime: "steady", name: "steady sliding", role: "steady" },
  { regime: "slow stick-slip", name: "slow stick-slip", role: "slow" },
  { regime: "stick-slip", name: "stick-slip", role: "stick" },
  { regime: "quasi-harmonic", name: "quasi-harmonic", role: "harmonic" },
  { regime: "unknown", name: "not known", role: "unknown" },
];
const LEAST_STRIP = 2; // px

export class Legend {
  /** list: element */
  constructor(list) {
    this.list = list;
    const regime = ({ name, role }) => this.entry(`patch ${role}`, explained(name, name));
    const places = REGIMES.slice(0, -1).map(regime);
    this.jump = this.entry("line jump", explained("lost with a jump", "lost with a jump"));
    this.strip = this.entry("patch coexistence", explained("coexistence", "coexistence"));
    this.regimes = [...places, regime(REGIMES.at(-1))];
    this.terms = new Roving(list, "[data-meaning]");
    this.size = this.entry("", "");
    this.size.className = "size";
    this.beyond = this.entry("point beyond", "the slider is beyond the map");
    this.beyond.className = "place";
  }

  entry(mark, words) {
    const item = element("li", { hidden: true }, element("span", { className: mark }), words);
    this.list.append(item);
    return item;
  }

  /**
   * What occurs in the cells shown.
   * atlas, part: RegimeCells, null while they are not known; regime: the slider's; stripWidth: px
   */
  tell(atlas, part, regime, plane) {
    this.list.classList.toggle("waiting", !atlas);
    if (!atlas) return;
    const all = part?.fills(plane);
    const shown = (all ? [part] : [atlas, part]).filter(Boolean);
    REGIMES.forEach((of, i) => this.keep(this.regimes[i], of.regime === regime || shown.some((cells) => cells.has(of.regime))));
    this.keep(this.jump, atlas.eta_bautin !== null);
    this.keep(this.strip, shown.some((cells) => cells.stripWidth(plane) >= LEAST_STRIP));
    this.terms.refresh();
    this.size.hidden = false;
    const about = part ? `; ${sized(part)} about this one` : "";
    this.size.textContent = all ? `${sized(part)} sliders` : `coarse: ${sized(atlas)} sliders${about}`;
  }

  /** Show an entry, or keep its place, so that the others do not move; what is seldom there has none. */
  keep(item, occurs) {
    item.hidden = item === this.regimes.at(-1) && !occurs;
    item.style.visibility = occurs ? "" : "hidden";
  }

  /** Nothing occurs. */
  clear() {
    this.list.classList.remove("waiting");
    for (const item of [...this.regimes, this.jump, this.strip, this.size]) item.hidden = true;
  }

  /** Whether the slider is beyond the map. */
  place(beyond) {
    this.beyond.hidden = !beyond;
  }
}

function sized({ size }) {
  return `${size} \u00d7 ${size}`;
}
