// The gap between tau/sigma and mu: what accelerates the block, and what a dashpot takes.

import { color } from "../common/theme.js";
import { number } from "../common/wire.js";

/** What makes tau/sigma differ from mu; "" if nothing does. */
export function gap({ values }) {
  const causes = [number(values.M) > 0 && "inertia", number(values.damping) > 0 && "damping"].filter(Boolean);
  return causes.length ? `gap: ${causes.join(" and ")}` : "";
}

/** A layer of the traces. */
export const inertia = {
  draw({ ctx }, name, X, Y, picture) {
    if (name !== "stress" || !gap(picture)) return;
    const { run_time: time, run_stress: stress, run_mu: mu } = picture.arrays;
    ctx.beginPath();
    for (let i = 0; i < time.length; i += 1) ctx.lineTo(X(time[i]), Y(stress[i]));
    for (let i = time.length - 1; i >= 0; i -= 1) ctx.lineTo(X(time[i]), Y(mu[i]));
    ctx.closePath();
    ctx.fillStyle = color("inertia");
    ctx.fill("evenodd");
  },
};
