// The place of a line that is nearest to a point.

/**
 * {distance, at} of a line through points; `at` counts its points, with a fraction between two.
 * Of places that are as close within `slack`, where the line passes several times, it is the last.
 */
export function nearest(xs, ys, x, y, slack = 0) {
  const pieces = Math.max(xs.length - 1, 0);
  const found = Array.from({ length: pieces }, (_, i) => onPiece(xs, ys, i, x, y));
  const closest = found.reduce((least, { distance }) => Math.min(least, distance), Infinity);
  let i = found.findLastIndex(({ distance }) => distance <= closest + slack);
  if (i < 0) return { distance: Infinity, at: NaN };
  while (i > 0 && found[i - 1].distance < found[i].distance) i -= 1; // the same passage's closest
  return found[i];
}

function onPiece(xs, ys, i, x, y) {
  const [dx, dy] = [xs[i + 1] - xs[i], ys[i + 1] - ys[i]];
  const along = ((x - xs[i]) * dx + (y - ys[i]) * dy) / (dx * dx + dy * dy || 1);
  const share = Math.min(1, Math.max(0, along));
  return { distance: Math.hypot(xs[i] + share * dx - x, ys[i] + share * dy - y), at: i + share };
}
