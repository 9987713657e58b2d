// Where axes have their ticks, and what stands there.

import { micro, powerOfTen, prefixOf } from "./numbers.js";

const NICE = [1, 2, 5, 10];

/** About `wanted` round values from low to high: [[value, text], ...]. */
export function linear(low, high, wanted) {
  const rough = (high - low) / Math.max(wanted, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * NICE.find((n) => n * power >= rough * 0.999);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k <= high / step + 1e-9; k += 1) {
    const value = k * step || 0; // not -0
    const far = Math.abs(value) >= 1e5 || (digits > 6 && value !== 0);
    ticks.push([value, far ? String(Number(value.toPrecision(6))) : value.toFixed(digits)]);
  }
  return ticks;
}

/** Ticks of speeds [m/s] on a logarithmic axis, and its unit: over less than a decade a fitting one. */
export function speeds(low, high, wanted) {
  if (high > 10 * low) return [logarithmic(low, high, wanted), "m/s"];
  const [power, prefix] = prefixOf(high, "m/s");
  const ticks = linear(low / 10 ** power, high / 10 ** power, Math.min(wanted, 5));
  return [ticks.map(([value, text]) => [value * 10 ** power, text]), micro(`${prefix}m/s`)];
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
        if (value >= low && value <= high) ticks.push([value, `${n}\u00b7${powerOfTen(p)}`]);
      }
    }
  }
  return ticks;
}
