// What an experiment changes: the times, and the load-point velocity between them.

import { color } from "./theme.js";

/** The load-point velocity of a picture, a function of time [s]. */
export function speedOf({ changes, values: { V_from, V_lp, protocol } }) {
  const speeds = [V_from ?? V_lp, ...protocol.map(([V]) => V), V_lp];
  return (time) => speeds[changes.findLastIndex((start) => start <= time) + 1];
}

/** A layer of the traces: a line at each change, of speed or normal stress, that does not begin the run. */
export const changes = {
  draw({ ctx, bbox }, name, X, Y, picture) {
    ctx.save();
    ctx.strokeStyle = color("edge");
    ctx.setLineDash([3, 3]);
    ctx.beginPath();
    for (const time of picture.changes.filter((start) => start > picture.arrays.run_time[0])) {
      const x = Math.round(X(time));
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
    }
    ctx.stroke();
    ctx.restore();
  },
};
