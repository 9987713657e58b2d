// Beside the traces: what their lines are, and the values at the instant.

import { element } from "../common/dom.js";
import { gap } from "./inertia.js";
import { round, shown } from "../common/numbers.js";
import { explained } from "../common/words.js";

/** values: {stress, mu, V} at a time [s], or null; [size, name] of the unit of time; picture: null before the first; layers: of `Traces` */
export function tell(readout, values, time, [size, unit], picture, layers) {
  const parts = [
    ["stress", "tau/sigma", "\u03c4/\u03c3", values && values.stress.toPrecision(6)],
    ["friction", "mu", "\u03bc", values && values.mu.toPrecision(6)],
    ["speed", "V", "V", values && shown(values.V, "m/s")],
  ].map(([role, meaning, name, value]) => explained(meaning, element("span", { className: `line ${role}` }), value ? `${name} = ${value}` : name));
  if (values) parts.push(`t = ${round(time / size, 5)} ${unit}`);
  else if (picture && gap(picture)) parts.push(element("span", {}, element("span", { className: "patch inertia" }), gap(picture)));
  parts.push(...layers.map((layer) => layer.key?.(values ? time : null)).filter(Boolean));
  readout.replaceChildren(...parts);
}
