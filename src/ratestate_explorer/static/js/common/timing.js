// How long it takes from a movement to its picture: performance entries named "slider-to-drawn".

const NAME = "slider-to-drawn";
const MOST = 500;
const begun = new Map(); // question's id -> time stamp of the event behind it
// uPlot draws in a microtask after the frame's own work, so the time is taken in the task after it.
const after = new MessageChannel();
after.port1.onmessage = ({ data }) => measure(data);

export function begin(id, stamp) {
  if (id !== null && stamp !== undefined) begun.set(id, stamp);
}

/** Everything up to this question is drawn now, or overtaken. */
export function drawn(id) {
  const start = begun.get(id);
  for (const known of [...begun.keys()]) if (known <= id) begun.delete(known);
  if (start !== undefined) after.port2.postMessage({ id, start });
}

function measure({ id, start }) {
  if (performance.getEntriesByName(NAME).length >= MOST) performance.clearMeasures(NAME);
  performance.measure(NAME, { start, end: performance.now(), detail: { id } });
}
