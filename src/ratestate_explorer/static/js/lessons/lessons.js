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
  todo: "At time 0 sliding is sped up: friction rises at once, and falls again as the contacts are renewed. Make the peak of mu twice as high above the level that follows, but end no faster than now. Leave a, b and the law as they are; what the contacts did before the step is yours to change.",
  look: "The dashed line of mu in the chart of the motion, just after time 0.",
  hint: "Contacts that slid slowly are old, and strong. Bring V_lp down to a tenth, press \u201cStep the speed\u201d, so that a step begins there, and bring V_lp up again. Or hold still before going on.",
  measure: (now) => `The peak is ${plain(peak(now), 3)} high; in the end V_lp is ${speed(now.values.V_lp)}.`,
  goals: [
    {
      text: "a peak twice as high as at first, while sliding ends no faster",
      met: (now, base) => !now.values.kick && peak(now) >= HIGHER * peak(base) && now.values.V_lp < 1.05 * base.values.V_lp,
    },
  ],
  astray(now, base) {
    if (now.values.kick) return "A kick changes the speed alone: no contact has healed. Take it back, and let the contacts grow old before the step.";
    if (peak(now) < peak(base) / 10) return "Sliding slows down at time 0 now. To have a peak, speed it up from there: press \u201cStep the speed\u201d.";
    const isFaster = now.values.V_lp >= 1.05 * base.values.V_lp;
    if (isFaster && peak(now) > 1.1 * peak(base)) return `The peak is higher because sliding ends faster. Bring V_lp back to ${speed(base.values.V_lp)}, and begin slower instead.`;
    return "";
  },
  learnt: "Contacts grow stronger with the logarithm of their age, in steady sliding Dc over V: ten times slower sliding before the step makes them ten times older, and the peak higher by b times ln 10. This healing is why a fault, or a door hinge, sticks the harder the longer it rests.",
};

const criticalStiffness = {
  name: "K_c",
  title: "Find the critical stiffness",
  preset: "Stick-slip",
  texts: {},
  free: ["K"],
  todo: "This block sticks and slips. Stiffen its spring until it slides steadily, and find how stiff it must just be: come close to the edge from below and from above, with nothing but K.",
  look: "The verdict, K/K_c in the table, and the mark of K_c over the slider of K.",
  hint: "Focus the slider of K and press the arrow keys: each is a step of 1.2 %. Or type a value a little below K_c, and one a little above.",
  measure: (now) => `K/K_c is ${plain(ratio(now), 4)}: ${now.regime === "steady" ? "steady sliding" : now.regime}.`,
  goals: [
    { text: "a cycle, with K less than 2 % below K_c", met: (now) => ratio(now) < 1 && ratio(now) > 1 - CLOSE && now.numbers.period !== null },
    { text: "steady sliding, with K less than 2 % above K_c", met: (now) => ratio(now) > 1 && ratio(now) < 1 + CLOSE && now.regime === "steady" },
  ],
  astray: (now) => (ratio(now) >= 1 + CLOSE ? "This is steady, but stiffer than it must be: the edge is further down." : ""),
  learnt: "A spring softer than K_c gives way too slowly: friction falls faster than its pull, and small disturbances grow into stick-slip. While inertia is small, K_c is b - a times sigma, over Dc: friction and normal stress alone decide how stiff a machine must be.",
};

const slowSlip = {
  name: "slow",
  title: "Make it slow",
  preset: "Step to stable sliding",
  texts: { V_from: null, V_lp: "100 um/s", K: "480 MPa/m" },
  free: ["K", "M", "V_lp"],
  todo: "This block slips in jerks, hundreds of times as fast as it is driven. Make the slips slow, as in slow earthquakes, but do not stop them. You may change K, M and V_lp.",
  look: "The fastest slip V_max in the table; the verdict says \u201cslow stick-slip\u201d when the force of inertia stays below a tenth of the swing of tau/sigma.",
  hint: "A slip is fast where the spring pulls much harder than friction holds. Let friction win by as little as possible: stiffen the spring to just below K_c.",
  measure: ({ values, numbers, regime }) => (numbers.period === null ? `The verdict is: ${regime}.` : `The fastest slip is ${speed(numbers.V_max)}, ${plain(numbers.V_max / values.V_lp, 3)} times V_lp: ${regime}.`),
  goals: [{ text: "slow stick-slip", met: (now) => now.regime === "slow stick-slip" }],
  astray(now, base) {
    if (now.values.M === 0) return "Without mass nothing limits the speed of a slip. Give M back.";
    if (now.regime === "steady") return "Now nothing slips at all: this is beyond the edge. Go back to just below K_c.";
    if (now.regime === "quasi-harmonic") return "This is vibration: inertia is all that counts. Drive it slower, or make it lighter.";
    if (now.regime === "slow stick-slip") return "";
    if (now.values.V_lp < base.values.V_lp / 2) return "Driven slower, it slips more seldom, but faster: contacts had longer to heal.";
    if (now.values.M < base.values.M / 2) return "A lighter block slips faster, not slower: inertia is what holds it back.";
    return now.values.M > base.values.M * 2 ? "A heavier block slips more slowly, but it is inertia that sets its pace: still stick-slip." : "";
  },
  learnt: "Slips are slow just below K_c, where the spring\u2019s pull falls almost as fast as friction, and little force is left to accelerate the block. Slower driving or a lighter block only makes slips rarer or faster: slow earthquakes may come from a fault near the edge of stability. (Other explanations exist.)",
};

const stop = {
  name: "stop",
  title: "Stop it without touching the spring",
  preset: "Step to just above V_c",
  texts: { V_from: null, V_lp: "10 mm/s" },
  free: ["M", "V_lp"],
  todo: "This block vibrates although its spring is stiffer than K_c_qs. Make it slide steadily in two ways: by V_lp alone, and, with V_lp as it was, by M alone.",
  look: "eta and K_c in the table, and the marks of V_c and M_c over their sliders.",
  hint: "Sliding is steady below V_c, and with a mass below M_c. After the first way, bring V_lp back to 10 mm/s, or press \u201cSet the sliders anew\u201d: what is done stays done.",
  measure: ({ values, numbers, regime }) => `eta is ${plain(numbers.eta)}; at this K sliding is steady where eta is below ${plain(values.K / numbers.K_c_qs - 1)}. Now: ${regime === "steady" ? "steady sliding" : regime}.`,
  goals: [
    { text: "steady sliding by V_lp alone", met: ({ values, regime }, base) => regime === "steady" && near(values.M, base.values.M) && !near(values.V_lp, base.values.V_lp) },
    { text: "steady sliding by M alone", met: ({ values, regime }, base) => regime === "steady" && near(values.V_lp, base.values.V_lp) && !near(values.M, base.values.M) },
  ],
  astray({ values, regime }, base) {
    const both = !near(values.V_lp, base.values.V_lp) && !near(values.M, base.values.M);
    if (both && regime === "steady") return `V_lp and M are both changed. Bring one back: V_lp to ${speed(base.values.V_lp)}, or M to ${shown(base.values.M, "kg/m^2")}.`;
    const isMore = values.V_lp > 1.05 * base.values.V_lp || values.M > 1.05 * base.values.M;
    return isMore && regime !== "steady" ? "That is more inertia: eta rose, and K_c with it. Go the other way." : "";
  },
  learnt: "Inertia raises K_c: eta grows with M, and with the square of V_lp. So a spring that is stiff enough for slow sliding is too soft above V_c, or under a block heavier than M_c. Only a spring stiffer than K_c_qs can be helped in this way; below it, sliding is unstable at any speed.",
};

const squeal = {
  name: "squeal",
  title: "Make it squeal",
  preset: "Step to just above V_c",
  texts: { V_from: null },
  free: ["K", "M", "V_lp"],
  todo: "This block hums at 51 Hz. Make it squeal, between 1 and 4 kHz, quasi-harmonic vibration. (Most squeal of disc brakes has another cause, the coupling of two modes.) You may change K, M and V_lp, but not friction.",
  look: "f in the table, f_n in the line under the goal, and the mark of V_c over the slider of V_lp.",
  hint: "A light block on a stiff spring is quick: f_n is the root of K/M, over 2\u03c0. But without inertia it does not vibrate at all: drive it faster, beyond V_c.",
  measure: ({ numbers, regime }) => (numbers.period === null ? `f_n is ${shown(numbers.f_n, "Hz", 3)}, but the verdict is: ${regime === "steady" ? "steady sliding" : regime}.` : `f is ${shown(numbers.frequency, "Hz", 3)}, f_n ${shown(numbers.f_n, "Hz", 3)}: ${regime}.`),
  goals: [{ text: "quasi-harmonic vibration between 1 and 4 kHz", met: ({ numbers, regime }) => regime === "quasi-harmonic" && numbers.frequency >= LOW && numbers.frequency <= HIGH }],
  astray({ values, numbers, regime }) {
    if (values.M === 0) return "Without mass nothing can vibrate. Give M back.";
    if (regime === "steady") return `It is silent: with eta = ${plain(numbers.eta)} inertia is too weak for this spring. Drive it faster, beyond V_c.`;
    if (regime.endsWith("stick-slip")) return `It sticks and slips: ${values.K < numbers.K_c_qs ? "the spring is softer than K_c_qs" : "inertia is weak, and K close to K_c_qs"}. Stiffen it, or drive it faster.`;
    return numbers.frequency > HIGH ? "That is too high for a squeal. Make the block heavier, or the spring softer." : "";
  },
  learnt: "Spring and block decide how high it squeals: well beyond V_c f is near f_n, set by K/M. Friction and inertia decide whether it does: in this model friction must weaken with speed, and a light block must be driven fast.",
};

export const LESSONS = [heal, criticalStiffness, slowSlip, stop, squeal];
