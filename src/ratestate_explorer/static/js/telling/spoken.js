// What is said to those who do not see the page.

import { $ } from "../common/dom.js";
import { plain } from "../common/numbers.js";
import { number } from "../common/wire.js";

const QUIET = 1000; // ms for which a picture must rest before it is announced

let announcing = 0;

/** Name what the charts show; and once the picture rests, announce its headline. */
export function describe({ sentences, numbers, values }) {
  const [what] = sentences;
  $("stress-chart").setAttribute("aria-label", `tau/sigma and mu against time. ${what}`);
  $("speed-chart").setAttribute("aria-label", `V against time. ${what}`);
  $("phase-canvas").setAttribute("aria-label", `V against tau/sigma. ${what}`);
  $("map-canvas").setAttribute("aria-label", `Regimes against K/K_c_qs and eta. Here ${place(numbers, values)}`);
  clearTimeout(announcing);
  announcing = setTimeout(announce, QUIET);
}

function place({ K_c_qs, eta, regime }, { K }) {
  if (!(K_c_qs > 0)) return "there are none: friction does not weaken";
  return `K/K_c_qs is ${plain(number(K) / K_c_qs)}, eta ${plain(number(eta))}, the regime ${regime}`;
}

function announce() {
  const text = $("headline").textContent;
  if ($("announcement").textContent !== text) $("announcement").textContent = text;
}
