"""The functions `hopf` and `bautin`: where steady sliding becomes unstable, and how."""

import numpy as np
import xarray

from ..friction.normal_form import (
    growth_slopes,
    law_curvatures,
    lyapunov_1,
    stress_swing,
    turning_point,
)
from ..friction.stability import K_c, V_c, eta, omega_c
from ..model.batch import Batch
from ..model.names import keywords_checked
from ..model.slider import checked
from ..model.units import is_array, named, to_si
from .refusals import refusal

VARIABLES = (
    "V_c K_c eta omega_c frequency eigenvalue_3 lyapunov_1 type amplitude_coefficient".split()
)


@keywords_checked
def hopf(slider, V_lp=None):
    """The Hopf bifurcation of steady sliding: its position and type, and its small cycles.

    Without V_lp, that on raising the speed at the slider's K, at V_c (eq. 10).  With V_lp, that
    on lowering the stiffness at this speed, at K_c (eq. 6); then the slider's K plays no part.

    Near it ln(V/V_lp) = r cos(omega t), with dr/dt = growth_rate r + lyapunov_1 r^3.
    Where lyapunov_1 < 0 the bifurcation is supercritical: small stable cycles appear on the
    unstable side (V > V_c, K < K_c) and grow from nothing.  Where it is positive, subcritical:
    small unstable cycles exist on the stable side (V < V_c, K > K_c), and sliding that has lost
    its stability jumps to a large cycle.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or DataArray, optional
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        In the dimensions of the named DataArrays together, at the bifurcation: speed ``V_c``
        [m/s] and stiffness ``K_c`` [Pa/m], ``eta`` (eq. 7), ``omega_c`` [rad/s] =
        (V/Dc) sqrt((b-a)/a) whatever the mass, ``frequency`` [Hz] = omega_c/(2 pi),
        ``eigenvalue_3`` [1/s] = -(1 + 1/eta) V/Dc, the rate at which all else decays,
        ``lyapunov_1`` [1/s] as above, ``type`` ("supercritical", "subcritical", "degenerate",
        "none") and ``amplitude_coefficient`` [1]: the small cycles have the amplitude (max - min
        of tau/sigma) amplitude_coefficient sqrt(|V_lp/V_c - 1|), or, with V_lp given,
        sqrt(|K/K_c - 1|); the attribute ``parameter`` says which ("V_lp" or "K").

        Degenerate is a lyapunov_1 within its rounding error of 0, which is 1e-14 of the terms
        that sum to it: where the type changes (see `bautin`), and without mass, for which it is
        0 at K_c_qs.  There amplitude_coefficient is inf.

        Where the type is "none" there is no bifurcation, and all else is NaN except V_c and K_c.
        Without V_lp, V_c is inf
        where no speed is unstable (b <= a, K = inf, or M = 0 with K > K_c_qs) and 0 where every
        speed is (K <= K_c_qs).  With V_lp, where b <= a, V_c is inf and K_c that of eq. 6, <= 0.

    Raises
    ------
    ParameterError
        V_lp is not a speed > 0, or names or coordinates clash.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> point = rs.hopf(slider)
    >>> str(point.type.values), round(float(point.frequency), 2)  # Hz
    ('supercritical', 50.33)
    """
    checked(slider)
    values = slider.values
    parameter = "V_lp" if V_lp is None else "K"
    other = {"K": values["K"]} if V_lp is None else {"V_lp": to_si("V_lp", V_lp)}
    batch = Batch({s: values[s] for s in ("a", "b", "Dc", "sigma", "M")} | other, taken=VARIABLES)
    batch.check_fits(len(VARIABLES), "ask for fewer at a time")
    columns = _bifurcation(slider.law, parameter, *map(batch.flat, batch.values))
    coords = batch.coordinates(VARIABLES)
    result = xarray.Dataset({s: batch.variable(columns[s], s) for s in VARIABLES}, coords)
    result["frequency"].attrs["long_name"] = "frequency at the Hopf bifurcation"
    result["lyapunov_1"].attrs["comment"] = "dr/dt = growth_rate r + lyapunov_1 r^3, r of ln V"
    over = "sqrt(|V_lp/V_c - 1|)" if V_lp is None else "sqrt(|K/K_c - 1|)"
    result["amplitude_coefficient"].attrs["comment"] = f"amplitude of small cycles over {over}"
    return result.assign_attrs(slider=repr(slider), law=slider.law, parameter=parameter)


def _bifurcation(law, parameter, a, b, Dc, sigma, M, other):
    """The result's variables, name -> (n,); `other` is K, or V_lp if the parameter is K."""
    rest = {"a": a, "Dc": Dc, "sigma": sigma, "M": M}
    if parameter == "V_lp":
        V = V_c(b=b, K=other, **rest)
        exists = (V > 0) & np.isfinite(V)
        K = np.where(exists, other, np.nan)
    else:
        exists = b > a
        V = np.where(exists, other, np.inf)
        K = K_c(other, b=b, **rest)
    V_hopf, b1 = np.where(exists, V, np.nan), np.where(exists, (b - a) / a, np.nan)
    inertia, rate = eta(V_hopf, **rest), V_hopf / Dc
    coefficient, rounding = lyapunov_1(inertia, b1, *law_curvatures(law))
    slope = growth_slopes(inertia, b1)[("V_lp", "K").index(parameter)]
    degenerate = np.abs(coefficient) <= rounding
    types = ("none", "degenerate", "supercritical")
    with np.errstate(divide="ignore"):
        r = np.sqrt(np.abs(slope / np.where(degenerate, 0.0, coefficient)))
        third = -(1 + 1 / inertia) * rate
    omega = omega_c(V_hopf, a=a, b=b, Dc=Dc)
    return {
        "V_c": V,
        "K_c": K,
        "eta": inertia,
        "omega_c": omega,
        "frequency": omega / (2 * np.pi),
        "eigenvalue_3": third,
        "lyapunov_1": coefficient * rate,
        "type": np.select([~exists, degenerate, coefficient < 0], types, "subcritical"),
        "amplitude_coefficient": a * stress_swing(inertia, b1) * r,
    }


def bautin(law, b_over_a):
    """The eta at which the Hopf bifurcation changes its type: the Bautin point.

    By the aging law the bifurcation is subcritical below it and supercritical above, at
    eta = 1/(3 + 2 sqrt(b/a + 3)); by the slip law it is supercritical at every eta > 0.
    eta is that of the bifurcation, as in `hopf`: of V_c, K/K_c_qs - 1.

    Parameters
    ----------
    law : {"slip", "aging"}
        Evolution law.
    b_over_a : float or DataArray
        b/a [1], > 1.

    Returns
    -------
    float, DataArray or None
        eta [1]; where the type never changes, None for a float and NaN inside a DataArray.

    Raises
    ------
    ParameterError
        Unknown law; b_over_a that is no number > 1.

    Examples
    --------
    >>> import ratestate as rs
    >>> round(rs.bautin("aging", 2.0), 4)
    0.1338
    """
    curvatures = law_curvatures(law)
    value = to_si("b_over_a", b_over_a)
    if not np.all(value > 1):
        raise refusal("cycles.b_over_a", least=float(np.min(value)))

    def change(b1):
        return turning_point(b1, *curvatures)

    if is_array(value):
        return named("eta", xarray.apply_ufunc(change, value - 1, vectorize=True))
    eta_bautin = float(change(value - 1))
    return None if np.isnan(eta_bautin) else eta_bautin
