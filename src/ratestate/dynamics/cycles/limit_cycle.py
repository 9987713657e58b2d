"""The verb `limit_cycle`: what a steadily driven slider settles into, and how firmly."""

import dataclasses
import functools
import json
from typing import Any

import numpy as np
import xarray

from ...engine.model import FINISHED, NO_CONVERGENCE, STEADY_SLIDING
from ...errors import ParameterError
from ...friction.laws import mu_ss
from ...friction.stability import K_c
from ...model.batch import Batch
from ...model.slider import SpringSlider, checked
from ...model.units import is_array, to_si
from ..progress import bar
from ..results import plain, provenance, status_variable
from ..simulation.cases import failure, speed
from ..simulation.domain import domain_variables
from .attractor import settle, steady_start
from .measure import refine
from .shooting import system_of

TAKEN = (
    "period frequency amplitude V_max V_min inertia slow_fraction fundamental multipliers"
    " multiplier stable residual error V_max_error V_min_error returns mu_min reversal_margin"
    " outside_domain status"
).split()
# Relative error beyond which an answer is refused.
WORST = 1e-2
# Sliders in hand at a time: enough to fill every lane, few enough to hold in memory.
CHUNK = 1 << 15


def limit_cycle(slider, V_lp, *, rtol=1e-8):
    """The cycle that a slider reaches from steady sliding at V_lp/10.

    By shooting: Newton's method on the return map of the section V = V_lp, where the stress has
    its maximum, with the map's derivative from the variational equations.  The motion from the
    start on decides which of several cycles, or steady sliding, it is; where it alternates, large
    and small in turn, the cycle is that of 2, 4, ... returns to the section (period doubling).

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity [m/s], > 0.
    rtol : float
        Relative accuracy of amplitude and period, from 1e-12 to 1e-2.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions:

        - ``period`` [s], ``frequency`` [Hz], ``amplitude`` (max - min of tau/sigma), ``V_max``
          and ``V_min`` [m/s], ``inertia`` (max |tau/sigma - mu| over the amplitude);
        - ``slow_fraction``, the part of the period in which V < V_lp/10, and ``fundamental``, the
          share, in the variance of tau, of the harmonic with one oscillation a return (1:
          harmonic, 6/pi^2: sawtooth);
        - ``multipliers``, complex, in the dimension ``multiplier``: the two Floquet multipliers
          beside the trivial 1, the larger first, by which small distances from the cycle change
          in a period.  Their product is the exponential of the integrated trace of the Jacobian;
          below 1e-8 no more than that is certain;
        - ``outside_domain`` (int8 with CF flags), whether the motion leaves the domain of the
          friction law, since friction would have to push (``mu_min``, its smallest mu, is
          negative), or since the spring pulls back harder than friction can hold
          (``reversal_margin``, the smallest tau/sigma + mu, is);
        - ``stable``, whether small disturbances decay;
        - ``residual``, the relative distance by which the cycle fails to close, and ``error``, the
          estimated relative error of amplitude and period, rounding of the parameters included,
          which a canard multiplies by up to 1e7 and more; ``V_max_error`` and ``V_min_error``,
          those of the speeds, which may exceed rtol where they span decades (a V_min below
          1e-260 V_lp is not told from rest);
        - ``returns``, how many returns to the section make the period: 1, 2, 4, ... up to 32, all
          of them counted in the other variables; 0 where there is no cycle;
        - ``status`` (int8 with CF flags).  0 is a cycle; 1 is steady sliding: amplitude, inertia
          and error are 0, V_max = V_min = V_lp, what only a cycle has is NaN.

    Raises
    ------
    ParameterError
        An input that cannot be used.
    QuasiStaticInstability
        M = 0, and the motion runs into an instability.
    NotConverged
        The motion settles into no cycle of 1, 2, 4, ... 32 returns, or double precision does not
        fix it to 1 %; ``best`` holds the last return.
    SolverError
        Any other failure.  In a sweep such cases are NaN, with their status.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> cycle = rs.limit_cycle(slider, V_lp="3.2 mm/s")
    >>> round(float(cycle.frequency), 3)  # Hz
    50.595
    >>> round(float(cycle.multipliers[0].real), 4)  # of a disturbance, left after a period
    0.9706
    """
    call = limit_cycle_call(slider, V_lp, rtol=rtol)
    call.batch.check_fits(len(TAKEN), "sweep into a store: sweep(limit_cycle, ..., store='x.zarr')")
    with bar("limit_cycle") as progress:
        result = call.dataset(call.run(progress))
    call.refuse_failure(result)
    return result


def limit_cycle_call(slider, V_lp, *, rtol):
    """`LimitCycleCall` with these arguments of `limit_cycle`, checked."""
    rtol = to_si("rtol", rtol)
    if is_array(rtol) or not 1e-12 <= rtol <= 1e-2:
        raise ParameterError(
            f"rtol = {rtol!r} is out of range; expected one number from 1e-12 to 1e-2 such as 1e-8"
        )
    return LimitCycleCall(checked(slider), to_si("V_lp", V_lp), rtol)


@dataclasses.dataclass(frozen=True, eq=False)
class LimitCycleCall:
    """`limit_cycle` with its arguments, checked and in SI."""

    slider: SpringSlider
    V_lp: Any
    rtol: float

    @functools.cached_property
    def batch(self):
        """All that has a value for each case."""
        return Batch({**self.slider.values, "V_lp": self.V_lp}, taken=TAKEN)

    def blank(self):
        """What `run` gives, without answers."""
        nothing = np.full(self.batch.n, NO_CONVERGENCE)
        variables = cycle_variables(self.batch, nothing, {}, stable=False)
        return variables | {"status": status_variable(self.batch, nothing)}

    def run(self, progress=None):
        """The result's variables, name -> Variable in the dimensions of the sweep."""
        return self.variables(*self.solve(progress))

    def solve(self, progress=None):
        """Status (n,) of all cases, and what `refine` found of those that have a cycle."""
        return _cycles(self.batch, self.slider.law, self.rtol, progress)

    def variables(self, status, found):
        """What `run` gives, of what `solve` found."""
        # Only cycles that attract are settled into; the multipliers of the softest round to 1.
        variables = cycle_variables(self.batch, status, found, stable=status == FINISHED)
        return variables | {"status": status_variable(self.batch, status)}

    def dataset(self, variables):
        """Variables of all cases as the result: with coordinates and provenance."""
        settings = {"rtol": self.rtol, "V_lp": json.dumps(plain(self.V_lp))}
        attrs = provenance("limit_cycle", self.slider, **settings)
        return xarray.Dataset(variables, self.batch.coordinates(TAKEN), attrs)

    def refuse_failure(self, result):
        """Raise what became of a single case that has no answer."""
        if self.batch.alone and (status := int(result.status)) > STEADY_SLIDING:
            best = result if status == NO_CONVERGENCE else None
            raise failure("limit_cycle", self.slider, status, best=best)


def _cycles(batch, law, rtol, progress):
    """Status (n,) of all cases, and what `refine` found of those that have a cycle."""
    system = system_of(law, **batch.columns)
    status = np.full(batch.n, STEADY_SLIDING)
    moves = np.flatnonzero((system.beta > 1.0) & np.isfinite(system.kappa))
    found: dict = {}
    alone = batch.alone
    for first in range(0, len(moves), CHUNK):
        which = moves[first : first + CHUNK]
        part = system.at(which)
        before, share = first / len(moves), len(which) / len(moves)
        advance = progress and (lambda done, b=before, s=share: progress(b + s * done))
        settled = settle(part, steady_start(part), rtol, alone, advance)
        status[which] = settled.status
        cycle = (settled.status == FINISHED) | (alone & (settled.status == NO_CONVERGENCE))
        for name, value in refine(part.at(cycle), settled.at(cycle), rtol, alone).items():
            empty = np.full((batch.n, *value.shape[1:]), np.nan, value.dtype)
            found.setdefault(name, empty)[which[cycle]] = value
    doubtful = (status == FINISHED) & ~(found.get("error", np.zeros(batch.n)) <= WORST)
    if found:  # what does not attract, seen closely, was not settled into
        doubtful |= (status == FINISHED) & ~(np.abs(found["multipliers"][:, 0]) < 1.0)
    status[doubtful] = NO_CONVERGENCE
    for value in () if alone else found.values():
        value[doubtful] = np.nan
    return status, found


def cycle_variables(batch, status, found, stable):
    """The result's variables, name -> Variable, of what `measure` found; NaN where it failed.

    batch : holds the slider and V_lp
    found : name -> (n,) or (n, 2), NaN where there is no cycle; empty where there is none at all
    stable : (n,) whether the cycles are
    """
    a, b, Dc, sigma, K, M, V = map(batch.flat, ("a", "b", "Dc", "sigma", "K", "M", "V_lp"))
    steady = status == STEADY_SLIDING
    nothing = np.full(batch.n, np.nan)

    def of(name, if_steady=np.nan):
        return np.where(steady, if_steady, found.get(name, nothing))

    period, amplitude = of("period") * Dc / V, of("amplitude", 0.0)
    multipliers = found.get("multipliers", np.full((batch.n, 2), np.nan, complex))
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            "period": period,
            "frequency": 1.0 / period,
            "amplitude": a * amplitude,
            "V_max": speed(of("v_max", 0.0), V),
            "V_min": speed(of("v_min", 0.0), V),
            "inertia": np.where(steady, 0.0, of("g_max") / amplitude),
            "slow_fraction": of("slow_fraction", 0.0),
            "fundamental": of("fundamental"),
            "stable": np.where(steady, K_c(V, a=a, b=b, Dc=Dc, sigma=sigma, M=M) < K, stable),
            "residual": of("residual", 0.0),
            "error": of("error", 0.0),
            "V_max_error": of("v_max_error", 0.0),
            "V_min_error": of("v_min_error", 0.0),
        }
    returns = np.nan_to_num(of("returns", 0.0)).astype(np.int16)
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    variables["returns"] = batch.variable(returns, "returns")
    steady_mu = mu_ss(V, a=a, b=b, mu0=batch.flat("mu0"), V0=batch.flat("V0"))
    lowest = (steady_mu + a * of("f_min", 0.0), 2.0 * steady_mu + a * of("xf_min", 0.0))
    variables |= domain_variables(batch, *lowest)
    variables["multipliers"] = batch.variable(multipliers, "multipliers", "multiplier")
    return variables
