// A run as the server sends it, between its points.

/** The index i with xs[i] <= x < xs[i + 1], of the first or last piece beyond the ends. */
export function pieceAt(xs, x) {
  let [low, high] = [0, xs.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= x) low = middle;
    else high = middle;
  }
  return low;
}

/** Where x is among rising xs, held within them: {i, j, share} of the way from point i to j. */
export function placeAt(xs, x) {
  const i = pieceAt(xs, x);
  const j = Math.min(i + 1, xs.length - 1);
  const share = xs[j] > xs[i] ? Math.min(1, Math.max(0, (x - xs[i]) / (xs[j] - xs[i]))) : 0;
  return { i, j, share };
}

/** The place that a number with a fraction counts, of so many points. */
export function placeOf(count, points) {
  const i = Math.floor(count);
  return { i, j: Math.min(i + 1, points - 1), share: count - i };
}

/** What values along the points are at a place, on straight lines. */
export function between(values, { i, j, share }) {
  return values[i] + share * (values[j] - values[i]);
}

/** Values from one time to another: at both, and at the points between. */
export function section(values, times, first, last) {
  const points = values.subarray(pieceAt(times, first) + 1, pieceAt(times, last) + 1);
  return [between(values, placeAt(times, first)), ...points, between(values, placeAt(times, last))];
}

/** {stress, mu, V} of a run's arrays at a time [s], held within it; null of a run without points. */
export function valuesAt({ run_time, run_stress, run_mu, run_V }, time) {
  if (!run_time.length) return null;
  const place = placeAt(run_time, time);
  const [before, after] = [run_V[place.i], run_V[place.j]];
  // Speeds change by decades between points.
  const V = before > 0 && after > 0 ? before * (after / before) ** place.share : between(run_V, place);
  return { stress: between(run_stress, place), mu: between(run_mu, place), V };
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
