"""One step of the paper's own scheme (eqs 8 and 9), at a fixed time step; order 1.

The motion over a step is the exact oscillation of mass and spring under the stress S of the
step's end; velocity, friction and state there are solved together (Im et al., 2017,
doi:10.1002/2017JB014476).  In the variables of `model`, with c and s the cosine and sine of
omega dt, omega = sqrt(K/M):

    x_new = (1 - c) S(v_new, psi_new) + c (x + kappa d_lp) - (kappa w/omega) s      (eq. 8)
    w_new = (2/h) (d_lp - (x_new - x)/kappa) - w                                         (eq. 9)

where d_lp is the load point's advance.  One unknown, v_new, remains.  The state is advanced
exactly for constant V = V_new, or, if the law knows it, by backward Euler (``im2017_euler``, as
the scheme's author published it).
"""

import math

from . import lanes as L
from . import rows as R
from .equations import exponentials_alone
from .exp import exp_alone
from .jit import inner, kernel
from .model import IM2017_EULER, NO_ROOT
from .rodas5p import dense_output
from .rows import rows_of
from .step_control import step_size
from .tuples import dot_onto, read_rows, store_each, total, write_rows, zeros

MAX_ITERATIONS = 200


@inner
def advance_state(law, method, psi, v, w, h, p):
    """psi after h at the constant velocity w = e**v, and its derivative by v: tuples."""
    if method == IM2017_EULER:
        return law.held_by_euler(psi, v, w, h, p)
    return law.held(psi, v, w, h, p)


@kernel
def solve_force_balance(law, method, kappa, p, y, w, d_lp, h, omega):
    """(x, v, psi) at the end of the step, and whether they could be solved for (else no answer).

    Newton in v, kept inside a bracket: the mismatch of eq. 9 runs from -inf to inf with v, so a
    root exists; steps are limited to 2 so that a far guess cannot overflow.

    p, y : tuples, the law's coefficients and (x, v, psi) at the start
    """
    one_c = 2.0 * math.sin(0.5 * omega * h) ** 2
    x = y[0]
    fixed = (1.0 - one_c) * (x + kappa * d_lp) - kappa * w * math.sin(omega * h) / omega
    low, high = -math.inf, math.inf
    v_new = y[1]
    for _ in range(MAX_ITERATIONS):
        w_new = exp_alone(v_new)
        psi_new, slope = advance_state(law, method, y[2:], v_new, w_new, h, p)
        x_new = one_c * law.stress(v_new, w_new, psi_new, p) + fixed
        S_v, S_psi = law.stress_partials(v_new, w_new, psi_new, p)
        mismatch = w_new + w - (2.0 / h) * (d_lp - (x_new - x) / kappa)
        if mismatch < 0.0:
            low = v_new
        else:
            high = v_new
        gradient = w_new + (2.0 / (h * kappa)) * one_c * dot_onto(S_v, S_psi, slope)
        move = -mismatch / gradient if gradient > 0.0 else (2.0 if mismatch < 0.0 else -2.0)
        move = min(max(move, -2.0), 2.0)
        # Rounding in x can hide the root below 1e-13 of v: a move that small is the answer even
        # where the bracket, one of its ends perhaps still infinite, would ask for another.
        tiny = 1e-13 * max(1.0, abs(v_new))
        if abs(move) > tiny and not low < v_new + move < high:
            move = 0.5 * (low + high) - v_new
        if abs(move) <= tiny:
            return (x_new, v_new, *psi_new), True
        v_new += move
    return (x_new, v_new, *psi_new), False


@inner
def take_step(s, l, law, method):
    """Take one step of the lane; record its outcome as `lanes.try_step` and `control_step` do.

    Where there is no solution, or no finite one, the lane's status is NO_ROOT.
    """
    rows = rows_of(law)
    _, kappa, eta0, p = L.system_of(s, l, law)
    y, w, w_lp = read_rows(s, rows.y, l), s[R.W + l], s[R.W_LP + l]
    s[R.H + l] = s[R.DT + l]
    h = step_size(s[R.DT + l], s[R.BREAKPOINT + l], s[R.T + l], s[R.T_LOW + l])
    dw = h * s[R.RAMP + l]
    omega = math.sqrt(kappa / eta0)
    d_lp = h * (w_lp + 0.5 * dw)
    y_new, solved = solve_force_balance(law, method, kappa, p, y, w, d_lp, h, omega)
    solved = solved and math.isfinite(y_new[0]) and math.isfinite(total(y_new[2:]))
    w_new, e_new = exponentials_alone(y_new, law, p)
    write_rows(s, rows.y_new, l, y_new)
    s[R.W_NEW + l] = w_new
    write_rows(s, rows.e_new, l, e_new)
    # Between its points the scheme says nothing; x is drawn as the cubic with its end slopes.
    x, x_new = y[0], y_new[0]
    rise = x_new - x
    first = h * kappa * (w_lp - w) - rise
    second = rise - h * kappa * (w_lp + dw - w_new) - first
    none = zeros(y)
    dense = dense_output(y, y_new, (first, *none[1:]), (second, *none[1:]), none)
    store_each(s, rows.c, l, dense)
    s[R.D_LOAD + l] = 0.5 * h * (x * w_lp + x_new * (w_lp + dw))
    stress = law.stress(y[1], w, y[2:], p), law.stress(y_new[1], w_new, y_new[2:], p)
    s[R.D_FRICTION + l] = 0.5 * h * (stress[0] * w + stress[1] * w_new)
    s[R.OK + l] = 1.0 if solved else 0.0
    s[R.H_USED + l], s[R.H_NEXT + l], s[R.MEMORY_NEW + l] = h, s[R.DT + l], 1.0
    L.has_event(s, l, law)
    if not solved:
        s[R.STATUS + l] = NO_ROOT
