"""Names of regimes, such as stick-slip, by the measured cycle and by the paper's criterion."""

import numpy as np
import xarray

from ...engine.model import FINISHED, STEADY_SLIDING
from ...friction.closed_forms import eta
from ...model.conversion import in_si
from ...model.quantities import attrs
from ..refusals import refusal
from ..results import parameter

STEADY, SLOW, STICK_SLIP, HARMONIC, UNKNOWN = REGIMES = (
    "steady",
    "slow stick-slip",
    "stick-slip",
    "quasi-harmonic",
    "unknown",
)
# Inertial force and stress of damping, divided by the amplitude, below which they are negligible.
SLOW_INERTIA = 0.1
# Share of the fundamental in the variance of the stress from which a cycle counts as harmonic: a
# sawtooth has 6/pi^2 = 0.61, a sine 1.
HARMONIC_SHARE = 0.87


def classify(cycle):
    """Name the regime of each case, by its measured cycle and by the paper's criterion.

    The regime of a measured cycle is the first of these that applies:

    - "unknown" if the cycle is unknown;
    - "steady" if there is no cycle;
    - "slow stick-slip" if inertia is negligible (``inertia`` < 0.1) and the stress of damping at
      V_max is below 0.1 times the amplitude;
    - "quasi-harmonic" if the fundamental's share in the variance of the stress is at least 0.87;
    - "stick-slip" otherwise.

    The paper's criterion (sec. 4.2) is stick-slip for eta < 1 and quasi-harmonic for eta >= 1.  For
    Figs 4 and 6 of the paper both criteria give the paper's names.  Regimes change gradually, and
    the thresholds are a convention.

    Parameters
    ----------
    cycle : xarray.Dataset
        From `limit_cycle` or `continue_cycle`.

    Returns
    -------
    xarray.Dataset
        In the dimensions of `cycle`, with the thresholds as attributes:

        - ``regime`` and ``regime_by_eta``: regime of the measured cycle, and by the paper's
          criterion.  Without a cycle both are "steady", or both are "unknown";
        - ``agree``: whether both are equal.  "slow stick-slip" counts as stick-slip.  False if the
          regime is unknown;
        - ``eta``: dynamic instability coefficient (eq. 7);
        - ``inertia``, ``fundamental``, ``slow_fraction`` and ``V_max`` [m/s] of `cycle`.

    Raises
    ------
    ParameterError
        If `cycle` is not such a result, has lost its attributes, or has a dimension called "eta".

    Notes
    -----
    ``slow_fraction`` is not a criterion, because not every cycle that the paper calls stick-slip
    sticks.  If state evolves only with slip, cycles with eta between 0.005 and 1 are never slower
    than V_lp/10.  ``V_max`` is not a criterion either, because V_max/V_lp falls gradually through
    all regimes.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
    >>> result = classify(rs.limit_cycle(slider, "3.2 mm/s"))
    >>> str(result.regime.values), str(result.regime_by_eta.values), bool(result.agree)
    ('quasi-harmonic', 'stick-slip', False)
    """
    required = {"inertia", "fundamental", "slow_fraction", "V_max", "amplitude", "status"}
    if not (isinstance(cycle, xarray.Dataset) and required <= set(cycle.data_vars)):
        raise refusal("regimes.no_cycles")
    cycle = in_si(cycle)
    if "eta" in cycle.dims:
        raise refusal("regimes.eta")
    measured = cycle[["inertia", "fundamental", "slow_fraction", "V_max"]]
    V_lp, a, Dc, sigma, M = (parameter(cycle, s) for s in ("V_lp", "a", "Dc", "sigma", "M"))
    eta_of_case = xarray.ones_like(cycle.inertia) * eta(V_lp, a=a, Dc=Dc, sigma=sigma, M=M)
    eta_of_case = eta_of_case.transpose(*cycle.inertia.dims).reset_coords(drop=True)
    regime = regimes_of(cycle, parameter(cycle, "damping"), sigma)
    no_cycle = np.isin(regime, [STEADY, UNKNOWN])
    by_eta = np.select([no_cycle, eta_of_case < 1.0], [regime, STICK_SLIP], HARMONIC)
    coarse_regime = np.where(regime == SLOW, STICK_SLIP, regime)
    dims = cycle.inertia.dims
    result = measured.assign(
        regime=(dims, regime, attrs("regime")),
        regime_by_eta=(dims, by_eta, attrs("regime_by_eta")),
        agree=(dims, (coarse_regime == by_eta) & (regime != UNKNOWN), attrs("agree")),
        eta=eta_of_case.assign_attrs(attrs("eta")),
    )
    result.attrs = {
        **cycle.attrs,
        "title": "ratestate regimes",
        "slow_inertia": SLOW_INERTIA,
        "harmonic_share": HARMONIC_SHARE,
    }
    return result


def regimes_of(cycle, damping, sigma):
    """Return the regimes by the measured cycles, as `classify` names them.

    cycle : mapping from the variables of `limit_cycle`, status among them, to arrays or numbers
    damping, sigma : of the sliders, in SI
    """
    status, inertia = cycle["status"], cycle["inertia"]
    has_cycle = (status == FINISHED) & ~np.isnan(inertia)
    damped = damping / sigma * cycle["V_max"]
    slow = (inertia < SLOW_INERTIA) & (damped < SLOW_INERTIA * cycle["amplitude"])
    harmonic = cycle["fundamental"] >= HARMONIC_SHARE
    conditions = [status == STEADY_SLIDING, np.logical_not(has_cycle), slow, harmonic]
    return np.select(conditions, [STEADY, UNKNOWN, SLOW, HARMONIC], STICK_SLIP)
