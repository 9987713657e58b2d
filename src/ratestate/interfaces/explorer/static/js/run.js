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
