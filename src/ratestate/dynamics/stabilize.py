"""The function `stabilize`: stiffness, mass or damping that makes steady sliding stable."""

import functools

import numpy as np

from ..friction.closed_forms import EDGE_WIDTH, call_elementwise
from ..friction.composition import composed
from ..friction.critical_speeds import V_c
from ..friction.laws import friction_law
from ..friction.linear_stability import K_c, is_stable
from ..model.arrays import Batch
from ..model.names import keywords_checked
from ..model.slider import check_slider
from ..model.units import to_si
from .recipe import recorded_result
from .results import own_variable

VARIABLES = (
    *("K_stable", "M_stable", "damping_stable", "damping_ratio_stable"),
    *("V_c_with_K", "V_c_with_M", "V_c_with_damping"),
)
#: natural logarithms of eta, and of damping V/(a sigma), between which M and damping are sought
SMALLEST, LARGEST = np.log(1e-15), np.log(1e15)
#: bisections, until the interval is below one rounding error
BISECTIONS = 64


@keywords_checked
def stabilize(slider, V_lp, margin=1.1):
    """Find the stiffness, mass or damping with which steady sliding is stable.

    Parameters
    ----------
    slider : SpringSlider
        Parameters may be named DataArrays.
    V_lp : float, str, pint.Quantity or xarray.DataArray
        Working speed [m/s], > 0.
    margin : float
        Each remedy alone makes steady sliding just stable at margin times V_lp.

    Returns
    -------
    xarray.Dataset
        In the dimensions of all named DataArrays:

        - ``K_stable``: least stiffness [Pa/m], less than K if the slider is stable; 0 if any
          stiffness suffices;
        - ``M_stable``: largest mass per area [kg/m^2]; inf if any mass will do, NaN if none will;
        - ``damping_stable``: least damping [Pa s/m]; 0 if none is needed;
        - ``damping_ratio_stable``: this damping divided by the critical damping 2 sqrt(K M); NaN if
          M = 0;
        - ``V_c_with_K``, ``V_c_with_M`` and ``V_c_with_damping``: critical velocity [m/s] after
          each remedy, and the slider's own V_c if no damping is needed.  With damping it may be 0:
          the slider then stays unstable at low speeds.  Without mass ``V_c_with_K`` holds for a K
          just above ``K_stable``: inf under most laws.

    Raises
    ------
    ParameterError
        If V_lp is not a speed > 0, margin is not a number > 0, or coordinates clash.

    Notes
    -----
    The stiffness is K_c at this speed, as in `stability`.  Mass and damping are found by bisection
    of the stability at this speed.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="1 GPa/m", M=3000)
    >>> found = stabilize(slider, "10 mm/s", margin=1.0)
    >>> [round(float(found[name]), 6) for name in ("K_stable", "M_stable", "V_c_with_K")]
    [3600000000.0, 400.0, 0.01]
    """
    slider = check_slider(slider)
    V_lp, margin = to_si("V_lp", V_lp), to_si("number", margin, label="margin", bound="> 0")
    batch = Batch({**slider.values, "V_lp": V_lp}, reserved=VARIABLES)
    damped = composed(friction_law(slider.law), slider.friction_form, damped=True)
    values = {"damping": 0.0} | batch.values
    given = {symbol: values[symbol] for symbol in (*damped.symbols, "sigma", "K", "M")}
    found = call_elementwise(
        functools.partial(_remedies, slider.friction_law, damped),
        {"V": margin * V_lp, **given},
        "remedy",
    )
    variables = {s: own_variable(batch, s, found[..., i]) for i, s in enumerate(VARIABLES)}
    settings = {"V_lp": V_lp, "margin": margin}
    return recorded_result("stabilize", slider, batch, variables, VARIABLES, **settings)


def _remedies(law, damped, *, V, K, M, **values):
    """Return the variables of `stabilize`, stacked along the last axis, from arrays (...)."""
    parameters = {symbol: values[symbol] for symbol in (*law.symbols, "sigma")}
    K_stable = np.maximum(K_c(law, V, M=M, **parameters), 0.0)
    unit = values["a"] * values["sigma"]
    unit_mass = unit * values["Dc"] / V**2  # at which eta is 1

    def stable_with_mass(M):
        return is_stable(law, V, K=K, M=M, **parameters)

    M_stable = unit_mass * _edge(stable_with_mass, unit_mass)
    M_stable = np.where(stable_with_mass(np.zeros_like(M)), M_stable, np.nan)
    others = {symbol: x for symbol, x in values.items() if symbol != "damping"}

    def unstable_with_damping(damping):
        return ~is_stable(damped, V, K=K, M=M, damping=damping, **others)

    damping = unit / V * _edge(unstable_with_damping, unit / V)
    damping = np.where(is_stable(law, V, K=K, M=M, **parameters), 0.0, damping)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.where(M > 0.0, damping / (2.0 * np.sqrt(K * M)), np.nan)
    with_M = np.where(np.isfinite(M_stable), M_stable, 0.0)
    V_c_with_K, stiffer = (
        V_c(law, K=K, M=M, **parameters).V_c for K in (K_stable, (1.0 + EDGE_WIDTH) * K_stable)
    )
    speeds = [
        # without mass, K_c is the same at all speeds
        np.where((M > 0.0) | (V_c_with_K > 0.0), V_c_with_K, stiffer),
        np.where(np.isnan(M_stable), np.nan, V_c(law, K=K, M=with_M, **parameters).V_c),
        V_c(damped, K=K, M=M, damping=damping, **others).V_c,
    ]
    return np.stack([K_stable, M_stable, damping, ratio, *speeds], axis=-1)


def _edge(holds, unit):
    """Return the ratio to a unit up to which a condition holds: inf if it holds everywhere.

    holds : function of an array like `unit`, True below the edge and False above
    """
    low, high = (np.full(np.shape(unit), x) for x in (SMALLEST, LARGEST))
    is_unbounded = holds(unit * np.exp(high))
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        below = holds(unit * np.exp(middle))
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.where(is_unbounded, np.inf, np.exp(low))
