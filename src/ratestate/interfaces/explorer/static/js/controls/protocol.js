// An experiment as texts, which are also those of a link, and what its buttons make of them.

import { entry } from "../common/numbers.js";

const SLIP = 20; // distances Dc that the slider slips between holds
const SECONDS = { ms: 1e-3, s: 1, min: 60, h: 3600, day: 86400, days: 86400, year: 31557600, years: 31557600 };
const LONGER = 10; // by which each hold is longer than the one before

/** The rows { V, sigma, duration } of a protocol, as texts; sigma is "" where it stays as it was. */
export function rowsOf(text) {
  if (!text) return [];
  return text.split(";").map((segment) => {
    const [conditions, duration] = halves(segment.trim().replace(/\s+/g, " "), " for ");
    const [V, sigma] = halves(conditions, " at ");
    return { V, sigma, duration };
  });
}

/** The protocol of these rows; null of none. */
export function textOf(rows) {
  return rows.map(({ V, sigma, duration }) => `${V}${sigma && ` at ${sigma}`} for ${duration}`).join("; ") || null;
}

function halves(text, mark) {
  const at = text.indexOf(mark);
  return at < 0 ? [text, ""] : [text.slice(0, at), text.slice(at + mark.length)];
}

/** Whether the normal stress is named anywhere in an experiment. */
export function sigmaVaries({ sigma_from, protocol }) {
  return Boolean(sigma_from) || rowsOf(protocol).some(({ sigma }) => sigma);
}

/** The conditions as they are now, { V_lp, sigma } in SI, as a row that lasts so long [s]. */
export function rowOf({ V_lp, sigma }, seconds, texts) {
  return { V: entry(V_lp, "m/s", 6), sigma: sigmaVaries(texts) ? entry(sigma, "Pa", 6) : "", duration: entry(seconds, "s", 3) };
}

/** The rows of a hold. */
export function hold(duration) {
  return [{ V: "0 m/s", sigma: "", duration }];
}

/**
 * The rows of three holds, each longer than the one before, the second of so many units of time;
 * between them slides that bring the stress back and go on for some distances Dc.
 *
 * values: in SI, of the slider and V_lp
 */
export function slideHoldSlide(count, unit, values) {
  const rows = [];
  for (const length of [1 / LONGER, 1, LONGER]) {
    const time = count * length;
    if (rows.length) rows.push({ V: entry(values.V_lp, "m/s", 6), sigma: "", duration: entry(sliding((time / LONGER) * SECONDS[unit.toLowerCase()], values), "s", 2) });
    rows.push(...hold(`${Number(time.toPrecision(6))} ${unit}`));
  }
  return rows;
}

/**
 * Seconds after a hold of so many in which the spring reloads and some Dc are slipped: at most, the
 * stress fell by a sigma ln(1 + K V_lp t/(a sigma)), and healed friction is b sigma ln(1 + V_lp t/Dc) higher.
 */
function sliding(held, { a, b, Dc, sigma, K, V_lp }) {
  const fallen = a * sigma * Math.log1p((K * V_lp * held) / (a * sigma));
  const healed = Math.max(b, 0) * sigma * Math.log1p((V_lp * held) / Dc);
  const loading = Number.isFinite(K) ? (fallen + healed) / K : 0;
  return (loading + SLIP * Dc) / V_lp;
}
