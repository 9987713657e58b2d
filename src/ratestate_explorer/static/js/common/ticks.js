// Where axes have their ticks, and what stands there.

import { micro, powerOfTen, prefixOf } from "./numbers.js";

const NICE = [1, 2, 5, 10];
// Range over size of values from which they differ in late digits only.
const FINE = 1e-4;

/** The round value that is this one or the next above: 1, 2 or 5 times a power of ten. */
export function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * NICE.find((n) => n * power >= value * 0.999);
}

/** About `wanted` round values from low to high: [[value, text], ...]. */
export function linear(low, high, wanted) {
  const step = roundUp((high - low) / Math.max(wanted, 1));
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k += 1) {
    const value = k * step || 0; // not -0
    const text = digits > 6 ? scientific(value, step) : value.toFixed(digits);
    ticks.push([value, text.replace(/^-/, "\u2212")]);
  }
  return ticks;
}

/** A value with the digits that the step tells apart. */
function scientific(value, step) {
  const digits = value === 0 ? 1 : Math.floor(Math.log10(Math.abs(value)) + 1e-9) - Math.floor(Math.log10(step) + 1e-9) + 1;
  return String(Number(value.toPrecision(Math.min(Math.max(digits, 1), 16))));
}

/**
 * Ticks of a range, and what stands behind the quantity in the label.
 * Where values differ in late digits only, ticks count from a value amid them, in a power of ten.
 */
export function counted(low, high, wanted, unit = "") {
  const range = high - low;
  const named = unit && `  [${unit}]`;
  if (range > FINE * Math.max(Math.abs(low), Math.abs(high))) return [linear(low, high, wanted), named];
  const power = Math.floor(Math.log10(range));
  const text = ((low + high) / 2).toFixed(Math.max(0, -power));
  const base = Number(text);
  const size = 10 ** power;
  const ticks = linear((low - base) / size, (high - base) / size, wanted);
  const label = unit ? ` \u2212 ${text} ${unit}  [${powerOfTen(power)} ${unit}]` : ` \u2212 ${text}  [${powerOfTen(power)}]`;
  return [ticks.map(([value, tick]) => [base + value * size, tick]), label];
}

/** Whether a speed has no place on a logarithmic axis. */
export const backward = (V) => V <= 0;

/** The same of speeds [m/s] on a logarithmic axis: over less than a decade, or back too, in a fitting unit. */
export function speeds(low, high, wanted) {
  if (!backward(low) && high > 10 * low) return [logarithmic(low, high, wanted), "  [m/s]"];
  const [power, prefix] = prefixOf(Math.max(-low, high), "m/s");
  const [ticks, label] = counted(low / 10 ** power, high / 10 ** power, Math.min(wanted, 5), micro(`${prefix}m/s`));
  return [ticks.map(([value, text]) => [value * 10 ** power, text]), label];
}

/** Powers of ten from low to high, thinned to about `wanted`; within few decades, also between. */
export function logarithmic(low, high, wanted) {
  const decades = Math.log10(high / low);
  const first = Math.ceil(Math.log10(low) - 1e-9);
  const last = Math.floor(Math.log10(high) + 1e-9);
  const every = [1, 2, 3, 4, 5, 10, 20, 50, 100].find((n) => decades / n <= Math.max(wanted, 2)) ?? 100;
  const ticks = [];
  for (let p = first - 1; p <= last; p += 1) {
    if (p % every === 0 && p >= first) ticks.push([10 ** p, powerOfTen(p)]);
    if (decades < 2.5) {
      for (const n of [2, 5]) {
        const value = n * 10 ** p;
        const text = p === 0 || p === 1 ? String(value) : `${n}\u00b7${powerOfTen(p)}`;
        if (value >= low && value <= high) ticks.push([value, text]);
      }
    }
  }
  return ticks;
}

/** The same where the range may be too narrow for round numbers of one digit: then about `wanted` others. */
export function zoomed(low, high, wanted) {
  const ticks = logarithmic(low, high, wanted);
  if (ticks.length > 2 || high > 10 * low) return ticks;
  return linear(low, high, wanted).map(([value, text]) => [value, text.replace(/e([+-]?\d+)$/, (_, power) => `\u00b7${powerOfTen(Number(power))}`)]);
}
