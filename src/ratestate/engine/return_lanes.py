"""Loops over the lanes of a return map: the state's step, and that of two perturbations of it."""

from . import lanes as L
from . import rows as R
from .jit import inlined, lanewise
from .tangent import step as tangent_step


@inlined
def step_of_lane(s, l, law, h):
    """What `tangent.step` gives for a step of size h from where the lane is."""
    y = (s[R.X + l], s[R.V + l], s[R.PSI + l])
    a = (s[R.X_A + l], s[R.V_A + l], s[R.PSI_A + l])
    b = (s[R.X_B + l], s[R.V_B + l], s[R.PSI_B + l])
    p = (law, s[R.KAPPA + l], s[R.BETA + l], s[R.ETA0 + l])
    return tangent_step(y, s[R.W + l], s[R.E + l], a, b, 1.0, h, p)


@inlined
def try_step(s, l, law):
    """Try one step of the lane, perturbations included, and record its outcome."""
    h = s[R.H + l]
    new, a_new, b_new, error, dense, s[R.D_TRACE + l] = step_of_lane(s, l, law, h)
    s[R.X_A_NEW + l], s[R.V_A_NEW + l], s[R.PSI_A_NEW + l] = a_new
    s[R.X_B_NEW + l], s[R.V_B_NEW + l], s[R.PSI_B_NEW + l] = b_new
    L.record(s, l, h, new, error, dense)


@lanewise
def advance(s, law, n):
    """Try one step in the first n lanes, accept or reject it, and see whether it holds events."""
    for l in range(n):
        try_step(s, l, law)
    L.assess(s, law, n)


@inlined
def commit_lane(s, l, law):
    """`lanes.commit_lane` for what a return map adds, once that is done.

    A perturbation along the orbit is a shift in time.  It grows and shrinks with the speed of the
    state, by twenty orders of magnitude in a stick-slip cycle, and would take all digits of the
    rest: it is taken out after each step.

    ================  ===================================================
    f_x, f_v, f_psi   speed of the state, d/dT
    pace              the largest of these; r_x, r_v, r_psi: their parts of it
    a_x, ...; b_x     the two perturbations after the step
    along_a, along_b  what they have along the orbit, over pace
    ================  ===================================================
    """
    ok = s[R.OK + l] > 0.0
    beta, w = s[R.BETA + l], s[R.W + l]
    x, v, psi = s[R.X + l], s[R.V + l], s[R.PSI + l]
    f_x = s[R.KAPPA + l] * (1.0 - w)
    f_psi = law.rate(w, v, psi, s[R.E + l])
    g = x - v - beta * psi
    rounding = 1e-13 * (abs(x) + abs(v) + abs(beta * psi))
    m = s[R.ETA0 + l] * w
    f_v = f_x - beta * f_psi if (abs(g) <= rounding) | (m == 0.0) else g / m
    pace = max(max(abs(f_x), abs(f_v)), max(abs(f_psi), 1e-300))
    r_x, r_v, r_psi = f_x / pace, f_v / pace, f_psi / pace
    share = 1.0 / (r_x * r_x + r_v * r_v + r_psi * r_psi)
    a_x, a_v, a_psi = s[R.X_A_NEW + l], s[R.V_A_NEW + l], s[R.PSI_A_NEW + l]
    b_x, b_v, b_psi = s[R.X_B_NEW + l], s[R.V_B_NEW + l], s[R.PSI_B_NEW + l]
    along_a = share * (a_x * r_x + a_v * r_v + a_psi * r_psi)
    along_b = share * (b_x * r_x + b_v * r_v + b_psi * r_psi)
    s[R.X_A + l] = a_x - along_a * r_x if ok else s[R.X_A + l]
    s[R.V_A + l] = a_v - along_a * r_v if ok else s[R.V_A + l]
    s[R.PSI_A + l] = a_psi - along_a * r_psi if ok else s[R.PSI_A + l]
    s[R.X_B + l] = b_x - along_b * r_x if ok else s[R.X_B + l]
    s[R.V_B + l] = b_v - along_b * r_v if ok else s[R.V_B + l]
    s[R.PSI_B + l] = b_psi - along_b * r_psi if ok else s[R.PSI_B + l]
    s[R.EARLY_A + l] += along_a / pace if ok else 0.0
    s[R.EARLY_B + l] += along_b / pace if ok else 0.0
    s[R.TRACE + l] += s[R.D_TRACE + l] if ok else 0.0
    s[R.SINCE + l] += s[R.OK + l]


@lanewise
def commit(s, law, n):
    """`commit_lane` in the first n lanes."""
    for l in range(n):
        commit_lane(s, l, law)
