"""The state-evolution laws (eqs 2 and 3): one row of `LAWS` each.

Each law is written once, in the log variables of the engine, which compiles this same source,

    w = V/V0,   v = ln w,   psi = ln(V0 theta/Dc),   e = exp(-psi),

as ``d psi/d(t V0/Dc)``.  They know no velocity but V0, so V0 may be chosen freely: the textbook
form ``d theta/dt`` (rate_and_state.py) is the same function with V0 := Dc/theta (then psi = 0 and
w = V theta/Dc).

Adding a law: its rate and derivatives, `NAME_runs_away` and one row of `LAWS` here, and its place
in the selection that the engine compiles (`state_rate` and `runs_away` in engine/model.py, the
loops in engine/lanes.py and engine/return_lanes.py, and engine/return_events.py).

Sources: Dieterich (1979) doi:10.1029/JB084iB05p02161 (aging), Ruina (1983)
doi:10.1029/JB088iB12p10359 (slip), Gu, Rice, Ruina & Tse (1984) doi:10.1016/0022-5096(84)90007-3
(runaway); equation numbers are those of Im, Marone & Elsworth (2019).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from ..errors import ParameterError

SLIP = 0
AGING = 1


def slip_rate(w, v, psi, e):
    """Slip (Ruina) law, eq. 3, as d psi/dT = -w (v + psi)."""
    return -w * (v + psi)


def slip_rate_partials(w, v, psi, e):
    """Derivatives of `slip_rate` with respect to v and psi."""
    return -w * (v + psi) - w, -w


def slip_rate_partials_2(w, v, psi, e):
    """Second derivatives of `slip_rate`: vv, v psi, psi psi."""
    return -w * (v + psi) - 2.0 * w, -w, 0.0


def slip_rate_partials_3(w, v, psi, e):
    """Third derivatives of `slip_rate`: vvv, vv psi, v psi psi, psi psi psi."""
    return -w * (v + psi) - 3.0 * w, -w, 0.0, 0.0


def aging_rate(w, v, psi, e):
    """Aging (Dieterich) law, eq. 2, as d psi/dT = exp(-psi) - w."""
    return e - w


def aging_rate_partials(w, v, psi, e):
    """Derivatives of `aging_rate` with respect to v and psi."""
    return -w, -e


def aging_rate_partials_2(w, v, psi, e):
    """Second derivatives of `aging_rate`: vv, v psi, psi psi."""
    return -w, 0.0, e


def aging_rate_partials_3(w, v, psi, e):
    """Third derivatives of `aging_rate`: vvv, vv psi, v psi psi, psi psi psi."""
    return -w, 0.0, 0.0, -e


def slip_runs_away(y, kappa, c):
    """Whether a slider without mass runs away for sure: Q = y - kappa/c >= 0, c = beta - 1 > 0.

    y = v + psi; with slip D instead of time dQ/dD = c Q + kappa w_lp/w, so that Q, once positive,
    grows for ever, whatever the load point does.  Where w >> w_lp it does not otherwise.  Numbers,
    not arrays; False where c <= 0.
    """
    return c > 0.0 and c * y >= kappa


def aging_runs_away(y, kappa, c):
    """Whether a slider without mass runs away for sure: exp(-y) <= 1 - kappa/c, kappa < c.

    dy/dD = c (1 - exp(-y)) - kappa + kappa w_lp/w then stays positive.  Where w >> w_lp it does
    not otherwise.  Numbers, not arrays; False where c <= kappa.
    """
    return c > kappa and y >= -math.log1p(-kappa / c)


class EvolutionLaw(NamedTuple):
    """A row of `LAWS`: code inside the engine, rate d psi/dT and its derivatives."""

    code: int
    rate: Callable
    rate_partials: Callable
    rate_partials_2: Callable
    rate_partials_3: Callable


#: name of an evolution law -> what it is
LAWS = {
    "slip": EvolutionLaw(
        SLIP, slip_rate, slip_rate_partials, slip_rate_partials_2, slip_rate_partials_3
    ),
    "aging": EvolutionLaw(
        AGING, aging_rate, aging_rate_partials, aging_rate_partials_2, aging_rate_partials_3
    ),
}


def evolution_law(law):
    """The row of `LAWS` with this name; ParameterError for an unknown one."""
    if not isinstance(law, str) or law not in LAWS:
        raise ParameterError(f"law = {law!r} is unknown; choose {' or '.join(map(repr, LAWS))}")
    return LAWS[law]
