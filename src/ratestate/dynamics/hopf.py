"""The functions `hopf` and `bautin`: where steady sliding becomes unstable, and how."""

from typing import NamedTuple

import numpy as np
import xarray

from ..friction.closed_forms import eta
from ..friction.critical_speeds import V_c
from ..friction.linear_stability import K_c, eigenvalues, linearisation, omega_c, other_modes
from ..friction.normal_form import (
    growth_slopes,
    law_curvatures,
    lyapunov_1,
    lyapunov_1_of_law,
    turning_point,
)
from ..model.arrays import Batch
from ..model.names import keywords_checked
from ..model.slider import check_slider
from ..model.units import is_array, named, to_si
from .refusals import check_one_length, refusal
from .results import provenance

VARIABLES = (
    "V_c K_c eta omega_c frequency eigenvalue_3 lyapunov_1 type amplitude_coefficient".split()
)


@keywords_checked
def hopf(slider, V_lp=None):
    """Locate the Hopf bifurcation of steady sliding, and describe its type and small cycles.

    Without V_lp, speed increases at the slider's K, and the bifurcation is at V_c (eq. 10).  With
    V_lp, stiffness decreases at this speed, and the bifurcation is at K_c (eq. 6), whatever the
    slider's K.  Laws of one length have closed formulas.  For other laws Kuznetsov's (2004) formula
    is evaluated numerically.

    Near the bifurcation ln(V/V_lp) = r cos(omega t), with dr/dt = growth_rate r + lyapunov_1 r^3.
    If lyapunov_1 < 0 the bifurcation is supercritical: small stable cycles appear on the unstable
    side (V > V_c, K < K_c) and grow from zero.  If lyapunov_1 > 0 it is subcritical: small unstable
    cycles exist on the stable side (V < V_c, K > K_c), and sliding that has lost its stability
    jumps to a large cycle.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or DataArray, optional
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        At the bifurcation, in the dimensions of the named DataArrays on which it depends.  If V_lp
        is given, nothing depends on K.

        - ``V_c`` [m/s], ``K_c`` [Pa/m] and ``eta`` [1] (eq. 7).  V_c is V_lp if it was given, else
          K_c is the slider's K.
        - ``omega_c`` [rad/s] and ``frequency`` [Hz] = omega_c/(2 pi).  Under laws of one length
          omega_c is (V/Dc) sqrt((b-a)/a) for any mass.
        - ``eigenvalue_3`` [1/s], the rate at which all other modes decay: -(1 + 1/eta) V/Dc under
          laws of one length, and so -inf without mass.
        - ``lyapunov_1`` [1/s].
        - ``type``: "supercritical", "subcritical", "degenerate" or "none".
        - ``amplitude_coefficient`` [1].  The amplitude of small cycles (max - min of tau/sigma) is
          amplitude_coefficient sqrt(|V_lp/V_c - 1|).  If V_lp was given, it is
          amplitude_coefficient sqrt(|K/K_c - 1|).

        The attribute ``parameter`` is "V_lp", or "K" if V_lp was given.

        The type is "degenerate" if lyapunov_1 is 0 within its rounding error.  This happens where
        the type changes (see `bautin`), and without mass under the laws of eqs 2 and 3.  Then
        amplitude_coefficient is inf.

        If the type is "none" there is no bifurcation, and all other numbers are NaN except V_c and,
        if V_lp was given, K_c.  Without V_lp, V_c is inf if no speed is unstable (b <= a, K = inf,
        or M = 0 with K > K_c_qs) and 0 if every speed is (K <= K_c_qs).  With V_lp and b <= a, V_c
        is inf and K_c <= 0.

    Raises
    ------
    ParameterError
        If V_lp is not a speed > 0, or if names or coordinates clash.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> point = rs.hopf(slider)
    >>> str(point.type.values), round(float(point.frequency), 2)  # Hz
    ('supercritical', 50.33)
    """
    law = check_slider(slider).friction_law
    values = slider.values
    parameter = "V_lp" if V_lp is None else "K"
    other = {"K": values["K"]} if V_lp is None else {"V_lp": to_si("V_lp", V_lp)}
    symbols = (*law.symbols, "sigma", "M")
    batch = Batch({s: values[s] for s in symbols} | other, reserved=VARIABLES)
    batch.check_fits(len(VARIABLES), "Ask for fewer at a time.")
    columns = _bifurcation(law, parameter, batch.columns)
    coords = batch.coordinates(VARIABLES)
    result = xarray.Dataset({s: batch.variable(columns[s], s) for s in VARIABLES}, coords)
    result["frequency"].attrs["long_name"] = "frequency at the Hopf bifurcation"
    result["lyapunov_1"].attrs["comment"] = "dr/dt = growth_rate r + lyapunov_1 r^3, r of ln V"
    distance = "sqrt(|V_lp/V_c - 1|)" if V_lp is None else "sqrt(|K/K_c - 1|)"
    result["amplitude_coefficient"].attrs["comment"] = f"amplitude of small cycles over {distance}"
    return result.assign_attrs(provenance("hopf", slider, law=slider.law, parameter=parameter))


def _bifurcation(law, parameter, columns):
    """Return the result's variables, name -> (n,), from parameters and K or V_lp."""
    rest = {symbol: columns[symbol] for symbol in ("sigma", "M", *law.symbols)}
    a, Dc, M = columns["a"], columns["Dc"], columns["M"]
    if parameter == "V_lp":
        V = V_c(law, K=columns["K"], **rest).V_c
        exists = (V > 0) & np.isfinite(V)
        K = np.where(exists, columns["K"], np.nan)
    else:
        K = K_c(law, columns["V_lp"], **rest)
        exists = K > 0
        V = np.where(exists, columns["V_lp"], np.inf)
    V_hopf = np.where(exists, V, np.nan)
    inertia, rate = eta(V_hopf, a=a, Dc=Dc, sigma=columns["sigma"], M=M), V_hopf / Dc
    point = _points(law, V_hopf, rest)
    slope = (point.by_V, point.by_K)[("V_lp", "K").index(parameter)]
    degenerate = np.abs(point.lyapunov_1) <= point.rounding
    types = ("none", "degenerate", "supercritical")
    with np.errstate(divide="ignore"):
        r = np.sqrt(np.abs(slope / np.where(degenerate, 0.0, point.lyapunov_1)))
    omega = point.omega * rate
    return {
        "V_c": V,
        "K_c": K,
        "eta": inertia,
        "omega_c": omega,
        "frequency": omega / (2 * np.pi),
        "eigenvalue_3": point.third * rate,
        "lyapunov_1": point.lyapunov_1 * rate,
        "type": np.select([~exists, degenerate, point.lyapunov_1 < 0], types, "subcritical"),
        "amplitude_coefficient": a * point.swing * r,
    }


class _Point(NamedTuple):
    """A Hopf bifurcation, dimensionless, times in Dc/V; arrays (n,), NaN if there is none."""

    omega: np.ndarray
    third: np.ndarray  # real part of the least stable of the other eigenvalues
    lyapunov_1: np.ndarray
    rounding: np.ndarray  # of that
    by_K: np.ndarray  # growth rate by ln K and by ln V
    by_V: np.ndarray
    swing: np.ndarray  # max - min of tau/(a sigma) for r = 1


def _points(law, V, values):
    """Return the `_Point` at speeds V; NaN where V is NaN."""
    exists = np.isfinite(V)
    points = np.full((len(_Point._fields), *V.shape), np.nan)
    if exists.any():
        points[:, exists] = _bifurcating(law, V[exists], {s: x[exists] for s, x in values.items()})
    return _Point(*points)


def _bifurcating(law, V, values):
    """Return the `_Point` at the speeds V, where steady sliding bifurcates at K_c."""
    M, sigma, unit = values["M"], values["sigma"], values["Dc"] / V
    critical = K_c(law, V, **values)
    inertia = eta(V, a=values["a"], Dc=values["Dc"], sigma=sigma, M=M)
    kappa = critical * values["Dc"] / (values["a"] * sigma)
    omega, p = omega_c(law, V, **values) * unit, law.coefficient_arrays(V, values)
    if law.one_length:  # in closed form
        b1 = (values["b"] - values["a"]) / values["a"]
        coefficient, rounding = lyapunov_1(inertia, b1, *law_curvatures(law.name))
    else:
        coefficient, rounding = lyapunov_1_of_law(law, p, kappa, inertia, omega)
    by_K, by_V = growth_slopes(linearisation(law, p), kappa, inertia, omega)
    if law.has_speed_scale:
        by_V = _growth_by_speed(law, V, critical, values)
    modes = eigenvalues(law, V, K=critical, **values)
    third = other_modes(modes, omega / unit).real.max(axis=1) * unit
    return _Point(omega, third, coefficient, rounding, by_K, by_V, 2.0 * kappa / omega)


def _growth_by_speed(law, V, K, values):
    """Return d growth rate/d ln V [V/Dc] at constant K, by central differences."""
    h = 1e-5
    sides = (
        eigenvalues(law, V * np.exp(side), K=K, **values)[:, 0].real * values["Dc"] / V
        for side in (h, -h)
    )
    return np.subtract(*sides) / (2 * h)


def bautin(law, b_over_a):
    """Return the eta at which the Hopf bifurcation changes its type: the Bautin point.

    Under the aging law the bifurcation is subcritical for eta < 1/(3 + 2 sqrt(b/a + 3)), and
    supercritical above.  Under the slip law it is supercritical at every eta > 0.  At the
    bifurcation eta equals K/K_c_qs - 1.

    Parameters
    ----------
    law : str
        Friction law of one length: d theta/dt depends only on V theta/Dc.
    b_over_a : float, 1-D array or DataArray
        b/a [1], > 1.

    Returns
    -------
    float or DataArray
        eta [1]; NaN if the type never changes.  An array gives a DataArray along ``b_over_a``.

    Raises
    ------
    ParameterError
        If the law is unknown or not of one length, or if b_over_a is not a number > 1.

    Examples
    --------
    >>> import ratestate as rs
    >>> round(rs.bautin("Dieterich", 2.0), 4)
    0.1338
    """
    check_one_length("bautin", law)
    curvatures = law_curvatures(law)
    value = to_si("b_over_a", b_over_a)
    if not np.all(value > 1):
        raise refusal("cycles.b_over_a", least=float(np.min(value)))

    def change(b1):
        return turning_point(b1, *curvatures)

    if is_array(value):
        return named("eta", xarray.apply_ufunc(change, value - 1, vectorize=True))
    return float(change(value - 1))
