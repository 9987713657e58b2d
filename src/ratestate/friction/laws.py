"""Rate-and-state friction: the friction law and the state-evolution laws (eqs 1-3).

Each evolution law is written once, in the log variables of the engine,

    w = V/V0,   v = ln w,   psi = ln(V0 theta/Dc),   e = exp(-psi),

as ``d psi/d(t V0/Dc)``.  They know no velocity but V0, so V0 may be chosen freely: the textbook
form ``d theta/dt`` is the same function with V0 := Dc/theta (then psi = 0 and w = V theta/Dc).
The functions of log variables are plain arithmetic, and the engine compiles this same source;
those of V and theta serve floats, NumPy arrays and named DataArrays, in SI units.

Adding a law: its rate and derivatives and one row of `LAWS` here, and its place in the selection
that the engine compiles (`state_rate` in engine/model.py, the loops in engine/lanes.py).

Sources: Dieterich (1979) doi:10.1029/JB084iB05p02161 (aging), Ruina (1983)
doi:10.1029/JB088iB12p10359 (slip); equation numbers are those of Im, Marone & Elsworth (2019).
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

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
    grows for ever, whatever the load point does.  Where w >> w_lp it does not otherwise.
    """
    return c > 0.0 and c * y >= kappa


def aging_runs_away(y, kappa, c):
    """Whether a slider without mass runs away for sure: exp(-y) <= 1 - kappa/c, kappa < c.

    dy/dD = c (1 - exp(-y)) - kappa + kappa w_lp/w then stays positive.  Where w >> w_lp it does
    not otherwise.
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


def friction(V, theta, *, a, b, mu0, V0, Dc):
    """Friction coefficient mu (eq. 1).

    mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc)

    Parameters
    ----------
    V : float, array or DataArray
        Slip velocity [m/s], > 0.
    theta : float, array or DataArray
        State [s], > 0.
    a, b, mu0 : float, array or DataArray
        Direct effect, evolution effect, friction in steady sliding at V0 [1].
    V0 : float, array or DataArray
        Reference velocity [m/s].
    Dc : float, array or DataArray
        Critical slip distance [m].

    Returns
    -------
    float, array or DataArray
        mu [1], in the shape that the arguments broadcast to.
    """
    return mu0 + a * np.log(V / V0) + b * np.log(V0 * theta / Dc)


def friction_partials(V, theta, *, a, b):
    """Derivatives of `friction`: a/V with respect to V, b/theta with respect to theta.

    Parameters
    ----------
    V, theta : float, array or DataArray
        Slip velocity [m/s] and state [s], > 0.
    a, b : float, array or DataArray
        Direct and evolution effect [1].

    Returns
    -------
    dmu_dV : float, array or DataArray
        Derivative with respect to V [s/m], in the shape that the arguments broadcast to.
    dmu_dtheta : float, array or DataArray
        Derivative with respect to theta [1/s].
    """
    return a / V, b / theta


def dtheta_dt(V, theta, *, Dc, law):
    """Rate of change of the state, d theta/dt [1] (aging: eq. 2, slip: eq. 3).

    With Omega = V theta/Dc: 1 - Omega (aging), -Omega ln(Omega) (slip, 0 at V = 0).

    Parameters
    ----------
    V : float, array or DataArray
        Slip velocity [m/s], >= 0.
    theta : float, array or DataArray
        State [s], > 0.
    Dc : float, array or DataArray
        Critical slip distance [m].
    law : {"slip", "aging"}
        Evolution law.

    Returns
    -------
    float, array or DataArray
        d theta/dt [1], in the shape that the arguments broadcast to.

    Raises
    ------
    ParameterError
        Unknown law.
    """
    omega = V * theta / Dc
    # Omega ln(Omega) -> 0 with Omega: the smallest float stands in for 0 under the logarithm
    return evolution_law(law).rate(omega, np.log(np.maximum(omega, 5e-324)), 0.0, 1.0)


def dtheta_dt_partials(V, theta, *, Dc, law):
    """Derivatives of `dtheta_dt` with respect to V and theta.

    d theta/dt depends on Omega = V theta/Dc alone, so both follow from one derivative; with
    V0 := V (w = 1, v = 0, psi = ln Omega) it is that of the law's rate with respect to v.

    Parameters
    ----------
    V, theta : float, array or DataArray
        Slip velocity [m/s] and state [s], > 0.
    Dc : float, array or DataArray
        Critical slip distance [m].
    law : {"slip", "aging"}
        Evolution law.

    Returns
    -------
    d_dV : float, array or DataArray
        Derivative with respect to V [s/m], in the shape that the arguments broadcast to.
    d_dtheta : float, array or DataArray
        Derivative with respect to theta [1/s].

    Raises
    ------
    ParameterError
        Unknown law.
    """
    omega = V * theta / Dc
    slope, _ = evolution_law(law).rate_partials(1.0, 0.0, np.log(omega), 1 / omega)
    return slope * theta / Dc, slope * V / Dc


def theta_ss(V, *, Dc):
    """State in steady sliding at V, the same for both laws: Dc/V.

    Parameters
    ----------
    V : float, array or DataArray
        Slip velocity [m/s].
    Dc : float, array or DataArray
        Critical slip distance [m].

    Returns
    -------
    float, array or DataArray
        theta_ss [s], in the shape that the arguments broadcast to.
    """
    return Dc / V


def mu_ss(V, *, a, b, mu0, V0):
    """Friction coefficient in steady sliding at V: mu0 + (a - b) ln(V/V0).

    Parameters
    ----------
    V : float, array or DataArray
        Slip velocity [m/s].
    a, b, mu0 : float, array or DataArray
        Direct effect, evolution effect, friction in steady sliding at V0 [1].
    V0 : float, array or DataArray
        Reference velocity [m/s].

    Returns
    -------
    float, array or DataArray
        mu_ss [1], in the shape that the arguments broadcast to.
    """
    return mu0 + (a - b) * np.log(V / V0)
