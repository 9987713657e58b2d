// A run as the server sends it, between its points.

/** The index i with times[i] <= time < times[i + 1], of the first or last piece beyond the ends. */
export function pieceAt(times, time) {
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

/** {stress, mu, V} of a run's arrays at a time [s], held within it; null of a run without points. */
export function valuesAt({ run_time: time, run_stress, run_mu, run_V }, t) {
  if (!time.length) return null;
  const i = pieceAt(time, t);
  const j = Math.min(i + 1, time.length - 1);
  const share = j > i ? Math.min(1, Math.max(0, (t - time[i]) / (time[j] - time[i]))) : 0;
  const between = (values) => values[i] + share * (values[j] - values[i]);
  const [before, after] = [run_V[i], run_V[j]];
  // Speeds change by decades between points.
  const V = before > 0 && after > 0 ? before * (after / before) ** share : between(run_V);
  return { stress: between(run_stress), mu: between(run_mu), V };
}

/** [least, greatest] of all values of some arrays; [Infinity, -Infinity] without any. */
export function extremes(arrays) {
  let [low, high] = [Infinity, -Infinity];
  for (const array of arrays) {
    for (const value of array) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/** The part of values whose times lie from first to last, with a point before and behind. */
export function within(times, values, first, last) {
  return values.subarray(pieceAt(times, first), pieceAt(times, last) + 2);
}
