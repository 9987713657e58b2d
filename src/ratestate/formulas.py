"""Closed forms, in SI units: friction, steady sliding and its stability, motion without mass.

The functions take floats, NumPy arrays and named DataArrays in SI, neither strings nor lists.
Ranges are not checked: a value out of range gives inf, NaN, or ZeroDivisionError.

Friction (eqs 1-3):

    mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc)                               (eq. 1)
    d theta/dt = 1 - V theta/Dc                           aging law         (eq. 2)
    d theta/dt = -(V theta/Dc) ln(V theta/Dc)             slip law          (eq. 3)

Sources: Dieterich (1979) doi:10.1029/JB084iB05p02161 (aging), Ruina (1983)
doi:10.1029/JB088iB12p10359 (slip); equation numbers follow Im, Marone & Elsworth (2019).
"""

import numpy as np

from .errors import ParameterError
from .friction.closed_forms import K_c, K_c_of_any_law, K_c_qs, V_c, eigenvalues, eta, f_n, omega_c
from .friction.laws import friction_law, one_length_laws
from .friction.point import Point
from .friction.quasi_static import (
    excursion,
    period,
    runaway_step,
    runaway_step_lower_bound,
    runaway_step_upper_bound,
)

__all__ = [
    "K_c",
    "K_c_of_any_law",
    "K_c_qs",
    "V_c",
    "dtheta_dt",
    "dtheta_dt_partials",
    "eigenvalues",
    "eta",
    "excursion",
    "f_n",
    "friction",
    "friction_partials",
    "mu_ss",
    "omega_c",
    "period",
    "runaway_step",
    "runaway_step_lower_bound",
    "runaway_step_upper_bound",
    "theta_ss",
]


def __dir__():
    return __all__


def friction(V, theta, *, a, b, mu0, V0, Dc):
    """Return the friction coefficient mu (eq. 1).

    mu = mu0 + a ln(V/V0) + b ln(V0 theta/Dc)

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s], > 0.
    theta : float, ndarray or DataArray
        State [s], > 0.
    a, b, mu0 : float, ndarray or DataArray
        Direct effect, evolution effect, friction in steady sliding at V0 [1].
    V0 : float, ndarray or DataArray
        Reference velocity [m/s].
    Dc : float, ndarray or DataArray
        Critical slip distance [m].

    Returns
    -------
    float, ndarray or DataArray
        mu [1], in the shape that the arguments broadcast to; -inf if V or theta is 0.
    """
    return mu0 + a * np.log(V / V0) + b * np.log(V0 * theta / Dc)


def friction_partials(V, theta, *, a, b):
    """Return the derivatives of `friction` with respect to V and theta.

    Parameters
    ----------
    V, theta : float, ndarray or DataArray
        Slip velocity [m/s] and state [s], > 0.
    a, b : float, ndarray or DataArray
        Direct and evolution effect [1].

    Returns
    -------
    dmu_dV : float, ndarray or DataArray
        Derivative with respect to V [s/m], in the shape that a and V broadcast to.
    dmu_dtheta : float, ndarray or DataArray
        Derivative with respect to theta [1/s], in the shape that b and theta broadcast to.
    """
    return a / V, b / theta


def dtheta_dt(V, theta, *, Dc, law):
    """Return the rate of change of the state, d theta/dt (aging: eq. 2, slip: eq. 3).

    With Omega = V theta/Dc: 1 - Omega (aging), -Omega ln(Omega) (slip, 0 at V = 0).

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s], >= 0.
    theta : float, ndarray or DataArray
        State [s], > 0.
    Dc : float, ndarray or DataArray
        Critical slip distance [m].
    law : str
        Friction law: "slip", "aging", "prz", or a law of your own if d theta/dt depends on
        V theta/Dc alone and its slope at V theta/Dc = 1 is -1.

    Returns
    -------
    float, ndarray or DataArray
        d theta/dt [1], in the shape that the arguments broadcast to.

    Raises
    ------
    ParameterError
        If the law is none of these.
    """
    omega = V * theta / Dc
    # Omega ln(Omega) -> 0 as Omega -> 0, so the smallest float replaces 0 in the logarithm
    v = np.log(np.maximum(omega, 5e-324))
    return Point(_one_length(law), (), (None, v, 0.0), omega).f[0]


def dtheta_dt_partials(V, theta, *, Dc, law):
    """Return the derivatives of `dtheta_dt` with respect to V and theta.

    Parameters
    ----------
    V, theta : float, ndarray or DataArray
        Slip velocity [m/s] and state [s], > 0.
    Dc : float, ndarray or DataArray
        Critical slip distance [m].
    law : str
        Friction law: "slip", "aging", "prz", or a law of your own if d theta/dt depends on
        V theta/Dc alone and its slope at V theta/Dc = 1 is -1.

    Returns
    -------
    d_dV : float, ndarray or DataArray
        Derivative with respect to V [s/m], in the shape that the arguments broadcast to.
    d_dtheta : float, ndarray or DataArray
        Derivative with respect to theta [1/s].

    Raises
    ------
    ParameterError
        If the law is none of these.
    """
    # both follow from the derivative by v = ln(V/V0), at V0 = V, where psi = ln(omega)
    omega = V * theta / Dc
    (slope,), _ = _one_length(law).at_speed(0.0, (np.log(omega),), ()).f_slopes
    return slope * theta / Dc, slope * V / Dc


def _one_length(law):
    """Return the law with this name; ParameterError unless it is of one length."""
    if not (instance := friction_law(law)).one_length:
        names = " or ".join(map(repr, one_length_laws()))
        raise ParameterError(
            "has no closed forms", f"Choose {names}.", symbol="law", value=repr(law)
        )
    return instance


def theta_ss(V, *, Dc):
    """Return the state in steady sliding at V under the slip or aging law, Dc/V.

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    Dc : float, ndarray or DataArray
        Critical slip distance [m].

    Returns
    -------
    float, ndarray or DataArray
        theta_ss [s], in the shape that the arguments broadcast to.
    """
    return Dc / V


def mu_ss(V, *, a, b, mu0, V0):
    """Return the friction coefficient in steady sliding, mu0 + (a - b) ln(V/V0).

    Parameters
    ----------
    V : float, ndarray or DataArray
        Slip velocity [m/s].
    a, b, mu0 : float, ndarray or DataArray
        Direct effect, evolution effect, friction in steady sliding at V0 [1].
    V0 : float, ndarray or DataArray
        Reference velocity [m/s].

    Returns
    -------
    float, ndarray or DataArray
        mu_ss [1], in the shape that the arguments broadcast to.
    """
    return mu0 + (a - b) * np.log(V / V0)
