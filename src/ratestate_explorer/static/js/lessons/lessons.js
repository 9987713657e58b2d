// The tasks: what each begins with, what it keeps, when it is done, and what it teaches.
// now: {values, numbers, arrays, regime} of a picture; base: the same of the one that the task began with.

import { plain, shown } from "../common/numbers.js";

const CLOSE = 0.02; // share of K_c that counts as close to it
const [LOW, HIGH] = [1000, 4000]; // Hz of a squeal
const HIGHER = 2; // times the peak that the first task begins with

/** Whether one value is another, as well as sliders and hands set it. */
export const near = (value, other, part = 0.05) => value === other || Math.abs(value / other - 1) < part;

const speed = (V) => shown(V, "m/s", 3);
const ratio = ({ values, numbers }) => values.K / numbers.K_c;

/** How far mu rises after the step above the level at which it ends. */
function peak({ arrays: { run_time: time, run_mu: mu } }) {
  const after = mu.slice(time.findIndex((t) => t >= 0));
  return after.length ? Math.max(...after) - after.at(-1) : 0;
}

const heal = {
  name: "heal",
  title: "Let the contacts heal",
  preset: "Velocity step, rigid drive",
  texts: { law: "aging", K: "10 GPa/m" }, // under which contacts heal in a hold, too
  free: ["V_lp"],
  todo: "At time 0 the speed rises. Friction rises at once, and falls again as new contacts replace the old. Make the peak of mu twice as high above the level that follows, but do not make the final speed higher. Keep a, b and the law. You may change what happens before the step.",
  look: "The dashed line of mu in the chart of the motion, just after time 0.",
  hint: "Contacts that slid slowly are old and strong. Reduce V_lp to a tenth and press \u201cStep the speed\u201d, so that the step begins there. Then raise V_lp again. Or use a hold.",
  measure: (now) => `The peak is ${plain(peak(now), 3)} high. V_lp ends at ${speed(now.values.V_lp)}.`,
  goals: [
    {
      text: "a peak twice as high as at first, with a final speed that is not higher",
      met: (now, base) => !now.values.kick && peak(now) >= HIGHER * peak(base) && now.values.V_lp < 1.05 * base.values.V_lp,
    },
  ],
  astray(now, base) {
    if (now.values.kick) return "A kick changes only the speed: no contact has healed. Undo it, and let the contacts grow old before the step.";
    if (peak(now) < peak(base) / 10) return "Sliding slows down at time 0 now. A peak needs a step to a higher speed: press \u201cStep the speed\u201d.";
    const isFaster = now.values.V_lp >= 1.05 * base.values.V_lp;
    if (isFaster && peak(now) > 1.1 * peak(base)) return `The peak is higher because sliding ends faster. Set V_lp back to ${speed(base.values.V_lp)}, and begin slower instead.`;
    return "";
  },
  learnt: "Contacts grow stronger with the logarithm of their age. In steady sliding the age is Dc divided by V. So ten times slower sliding before the step makes the contacts ten times older, and the peak higher by b times ln 10. This is healing: the longer a surface rests, the harder it is to move.",
};

const criticalStiffness = {
  name: "K_c",
  title: "Find the critical stiffness",
  preset: "Stick-slip",
  texts: {},
  free: ["K"],
  todo: "This block sticks and slips. Make its spring stiffer until it slides steadily, and find the smallest stiffness that is enough. Change only K. Come close to this value from below and from above.",
  look: "The verdict, K/K_c in the table, and the mark of K_c above the slider of K.",
  hint: "Click the slider of K and press the arrow keys: each press changes K by 1.2 %. Or type a value slightly below K_c, then one slightly above.",
  measure: (now) => `K/K_c is ${plain(ratio(now), 4)}: ${now.regime === "steady" ? "steady sliding" : now.regime}.`,
  goals: [
    { text: "a cycle, with K less than 2 % below K_c", met: (now) => ratio(now) < 1 && ratio(now) > 1 - CLOSE && now.numbers.period !== null },
    { text: "steady sliding, with K less than 2 % above K_c", met: (now) => ratio(now) > 1 && ratio(now) < 1 + CLOSE && now.regime === "steady" },
  ],
  astray: (now) => (ratio(now) >= 1 + CLOSE ? "This is steady, but the spring is stiffer than it must be. Reduce K." : ""),
  learnt: "If the spring is softer than K_c, friction falls faster with slip than the pull of the spring. Then small disturbances grow into stick-slip. If inertia is small, K_c is b - a times sigma, divided by Dc: only friction and normal stress decide how stiff a machine must be.",
};

const slowSlip = {
  name: "slow",
  title: "Make it slow",
  preset: "Step to stable sliding",
  texts: { V_from: null, V_lp: "100 um/s", K: "480 MPa/m" },
  free: ["K", "M", "V_lp"],
  todo: "This block slips in jerks, hundreds of times faster than the load point moves. Make the slips slow, as in slow earthquakes, but do not stop them. You may change K, M and V_lp.",
  look: "The fastest slip V_max in the table, and the verdict. It is \u201cslow stick-slip\u201d if the inertial force stays below a tenth of the amplitude of tau/sigma.",
  hint: "A slip is fast if the spring pulls much harder than friction resists. Make this difference as small as possible: raise K to just below K_c.",
  measure: ({ values, numbers, regime }) => (numbers.period === null ? `The verdict is: ${regime}.` : `The fastest slip is ${speed(numbers.V_max)}, ${plain(numbers.V_max / values.V_lp, 3)} times V_lp: ${regime}.`),
  goals: [{ text: "slow stick-slip", met: (now) => now.regime === "slow stick-slip" }],
  astray(now, base) {
    if (now.values.M === 0) return "Without mass nothing limits the speed of a slip. Give the block a mass.";
    if (now.regime === "steady") return "Now the block slides steadily: K is above K_c. Go back to just below K_c.";
    if (now.regime === "quasi-harmonic") return "This is vibration: inertia dominates. Reduce V_lp or M.";
    if (now.regime === "slow stick-slip") return "";
    if (now.values.V_lp < base.values.V_lp / 2) return "At a lower V_lp it slips less often, but faster: the contacts have more time to heal.";
    if (now.values.M < base.values.M / 2) return "A lighter block slips faster, not slower: inertia is what holds it back.";
    return now.values.M > base.values.M * 2 ? "A heavier block slips more slowly, but inertia still limits its speed. This is stick-slip." : "";
  },
  learnt: "Slips are slow just below K_c, where the pull of the spring falls almost as fast as friction. Then little force is left to accelerate the block. A lower V_lp or M only makes slips rarer or faster. So slow earthquakes may come from faults near the edge of stability. (Other explanations exist.)",
};

const stop = {
  name: "stop",
  title: "Stop it without touching the spring",
  preset: "Step to just above V_c",
  texts: { V_from: null, V_lp: "10 mm/s" },
  free: ["M", "V_lp"],
  todo: "This block vibrates although its spring is stiffer than K_c_qs. Make it slide steadily in two ways. First change only V_lp. Then set V_lp back, and change only M.",
  look: "eta and K_c in the table, and the marks of V_c and M_c above the sliders.",
  hint: "Sliding is steady below V_c, and with a mass below M_c. After the first way, set V_lp back to 10 mm/s, or press \u201cReset the sliders\u201d. A goal that you reached stays reached.",
  measure: ({ values, numbers, regime }) => `eta is ${plain(numbers.eta)}. At this K sliding is steady if eta is below ${plain(values.K / numbers.K_c_qs - 1)}. Now: ${regime === "steady" ? "steady sliding" : regime}.`,
  goals: [
    { text: "steady sliding by a change of V_lp only", met: ({ values, regime }, base) => regime === "steady" && near(values.M, base.values.M) && !near(values.V_lp, base.values.V_lp) },
    { text: "steady sliding by a change of M only", met: ({ values, regime }, base) => regime === "steady" && near(values.V_lp, base.values.V_lp) && !near(values.M, base.values.M) },
  ],
  astray({ values, regime }, base) {
    const both = !near(values.V_lp, base.values.V_lp) && !near(values.M, base.values.M);
    if (both && regime === "steady") return `V_lp and M are both changed. Set one back: V_lp to ${speed(base.values.V_lp)}, or M to ${shown(base.values.M, "kg/m^2")}.`;
    const isMore = values.V_lp > 1.05 * base.values.V_lp || values.M > 1.05 * base.values.M;
    return isMore && regime !== "steady" ? "This is more inertia: eta rose, and K_c with it. Reduce V_lp or M instead." : "";
  },
  learnt: "Inertia raises K_c: eta grows with M, and with the square of V_lp. So a spring that is stiff enough for slow sliding is too soft above V_c, or under a block heavier than M_c. This works only if the spring is stiffer than K_c_qs. If it is softer, sliding is unstable at any speed.",
};

const squeal = {
  name: "squeal",
  title: "Make it squeal",
  preset: "Step to just above V_c",
  texts: { V_from: null },
  free: ["K", "M", "V_lp"],
  todo: "This block hums at 51 Hz. Make it squeal: quasi-harmonic vibration between 1 and 4 kHz. (Most squeal of disc brakes has another cause, the coupling of two modes.) You may change K, M and V_lp, but not friction.",
  look: "f in the table, f_n in the line under the goal, and the mark of V_c above the slider of V_lp.",
  hint: "A light block on a stiff spring has a high f_n, the square root of K/M divided by 2\u03c0. But with too little inertia it does not vibrate: raise V_lp above V_c.",
  measure: ({ numbers, regime }) => (numbers.period === null ? `f_n is ${shown(numbers.f_n, "Hz", 3)}, but the verdict is: ${regime === "steady" ? "steady sliding" : regime}.` : `f is ${shown(numbers.frequency, "Hz", 3)}, f_n ${shown(numbers.f_n, "Hz", 3)}: ${regime}.`),
  goals: [{ text: "quasi-harmonic vibration between 1 and 4 kHz", met: ({ numbers, regime }) => regime === "quasi-harmonic" && numbers.frequency >= LOW && numbers.frequency <= HIGH }],
  astray({ values, numbers, regime }) {
    if (values.M === 0) return "Without mass nothing can vibrate. Give the block a mass.";
    if (regime === "steady") return `It is silent: with eta = ${plain(numbers.eta)} inertia is too weak for this spring. Raise V_lp above V_c.`;
    if (regime.endsWith("stick-slip")) return `It sticks and slips: ${values.K < numbers.K_c_qs ? "the spring is softer than K_c_qs" : "inertia is weak, and K close to K_c_qs"}. Raise K or V_lp.`;
    return numbers.frequency > HIGH ? "That is too high for a squeal. Make the block heavier, or the spring softer." : "";
  },
  learnt: "K/M decides the pitch: well above V_c, f is near f_n. Friction and inertia decide whether it squeals at all. In this model friction must weaken with speed, and a light block needs a high V_lp.",
};

export const LESSONS = [heal, criticalStiffness, slowSlip, stop, squeal];
