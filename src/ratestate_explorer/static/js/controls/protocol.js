// The rows of an experiment, { V, sigma, duration } as texts: made by buttons, written as the server reads them.

import { entry } from "../common/numbers.js";

/** Rows as the server sends them; sigma is "" if it does not change. */
export function rowsOf(sent) {
  return sent.map(([V, sigma, duration]) => ({ V, sigma: sigma ?? "", duration }));
}

/** The protocol of these rows; null of none. */
export function textOf(rows) {
  return rows.map(({ V, sigma, duration }) => `${V}${sigma && ` at ${sigma}`} for ${duration}`).join("; ") || null;
}

/** Whether the normal stress is named anywhere in an experiment. */
export function sigmaVaries({ sigma_from }, rows) {
  return Boolean(sigma_from) || rows.some(({ sigma }) => sigma);
}

/** The conditions as they are now, { V_lp, sigma } in SI, as a row that lasts so long [s]. */
export function rowOf({ V_lp, sigma }, seconds, varies) {
  return { V: entry(V_lp, "m/s", 6), sigma: varies ? entry(sigma, "Pa", 6) : "", duration: entry(seconds, "s", 3) };
}
