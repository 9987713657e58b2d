"""The function `limit_cycle`: the attractor of a steadily driven slider, and its multipliers."""

import dataclasses
import functools
from typing import Any

import numpy as np
import xarray

from ...engine.model import FINISHED, NO_CONVERGENCE, STEADY_SLIDING
from ...model.arrays import Batch
from ...model.initial_state import check_speed_ratio
from ...model.names import keywords_checked
from ...model.slider import SpringSlider, check_slider
from ...model.units import to_si
from ..progress import bar
from ..recipe import record_scenario
from ..refusals import refusal
from ..simulation.cases import failure
from ..simulation.settings import checked_rtol
from .attractor import SLOWER, find_attractors, steady_start
from .measure import refine
from .system import system_of
from .variables import VARIABLES, cycle_variables

# Relative error beyond which an answer is refused.
WORST = 1e-2
# Sliders at a time: enough to fill every lane, few enough to hold in memory.
CHUNK = 1 << 15


@keywords_checked
def limit_cycle(slider, V_lp, *, V_start=None, rtol=1e-8):
    """The cycle that a slider reaches from steady sliding at V_start.

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
    V_start : float, str, pint.Quantity or DataArray, optional
        Slip velocity of the steady sliding from which the motion starts [m/s], > 0 and not V_lp;
        V_lp/10 by default.  From others a slider may come to another cycle, or without mass not
        run away.
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
        - ``multipliers``, complex, in the dimension ``multiplier``: the Floquet multipliers
          beside the trivial 1, one more than the law has states, the largest first, by which small
          distances from the cycle change in a period.  Their product is the exponential of the
          integrated trace of the Jacobian; below 1e-8 no more than that is certain.
          ``multipliers_error`` is the estimated error of each, absolute; with cut-offs it may
          exceed rtol;
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
    call = limit_cycle_call(slider, V_lp, V_start=V_start, rtol=rtol)
    into_store = "Sweep into a store, sweep(limit_cycle, ..., store='x.zarr')."
    call.batch.check_fits(len(VARIABLES), into_store)
    with bar("limit_cycle") as progress:
        result = call.dataset(call.run(progress))
    call.refuse_failure(result)
    return result


def limit_cycle_call(slider, V_lp, *, V_start=None, rtol):
    """`LimitCycleCall` with these arguments of `limit_cycle`; ParameterError where one is wrong.

    Whether their dimensions and coordinates fit together shows in its `batch`.
    """
    rtol = checked_rtol(rtol, "1e-12", "1e-2", "1e-8")
    V_lp = to_si("V_lp", V_lp)
    if V_start is not None:
        V_start = to_si("V_start", V_start)
        if np.any(V_start == V_lp):
            raise refusal("cycles.undisturbed")
    return LimitCycleCall(check_slider(slider), V_lp, V_start, rtol)


@dataclasses.dataclass(frozen=True, eq=False)
class LimitCycleCall:
    """`limit_cycle` with its arguments, checked and in SI."""

    slider: SpringSlider
    V_lp: Any
    V_start: Any  # None for the usual one
    rtol: float

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, V_lp and V_start.

        ParameterError where dimensions or coordinates clash with each other or with the result's,
        or V_start is beyond 1e-260 or 1e260 times V_lp.
        """
        start = {} if self.V_start is None else {"V_start": self.V_start}
        batch = Batch({**self.slider.values, "V_lp": self.V_lp, **start}, reserved=VARIABLES)
        if start:
            speeds = batch.flat("V_start"), "V_lp", batch.flat("V_lp")
            check_speed_ratio(self.slider.friction_law, "V_start", *speeds)
        return batch

    def blank(self):
        """The variables of `run` with no case solved: NaN, status NO_CONVERGENCE."""
        status = np.full(self.batch.n, NO_CONVERGENCE)
        return cycle_variables(self.slider.friction_law, self.batch, status, {}, stable=False)

    def run(self, progress=None):
        """The result's variables, name -> Variable in the dimensions of the sweep.

        A case without a cycle raises nothing: it has its status.
        """
        return self.variables(*self.find_cycles(progress))

    def variables(self, status, measures):
        """The variables of `run`, from the results of `find_cycles`."""
        # An attractor is stable, though the multipliers of the smallest cycles round to 1.
        stable = status == FINISHED
        return cycle_variables(self.slider.friction_law, self.batch, status, measures, stable)

    def find_cycles(self, progress=None):
        """Status (n,) of all cases, and the measures of their cycles as by `refine`, of (n, ...).

        They are NaN where the status is no cycle, but for a single case that has not converged; and
        {} where no case can have a cycle (K = inf, or steady sliding stable at any K).
        """
        n, alone = self.batch.n, self.batch.is_single
        system = system_of(self.slider.friction_law.name, **self.batch.columns)
        status = np.full(n, STEADY_SLIDING)
        may_cycle = np.flatnonzero(system.may_cycle)
        measures: dict = {}
        for first in range(0, len(may_cycle), CHUNK):
            which = may_cycle[first : first + CHUNK]
            part = system.at(which)
            before, share = first / len(may_cycle), len(which) / len(may_cycle)
            advance = progress and (lambda done, b=before, s=share: progress(b + s * done))
            start = steady_start(part, self._slower(which))
            attractors = find_attractors(part, start, self.rtol, advance)
            status[which] = attractors.status
            cycle = attractors.status == FINISHED
            cycle |= alone & (attractors.status == NO_CONVERGENCE)
            values = refine(part.at(cycle), attractors.at(cycle), self.rtol)
            for name, value in values.items():
                empty = np.full((n, *value.shape[1:]), np.nan, value.dtype)
                measures.setdefault(name, empty)[which[cycle]] = value
        if measures:
            # A cycle that proves to be unstable is not the attractor.
            good = (measures["error"] <= WORST) & (np.abs(measures["multipliers"][:, 0]) < 1.0)
            doubtful = (status == FINISHED) & ~good
            status[doubtful] = NO_CONVERGENCE
            for value in () if alone else measures.values():
                value[doubtful] = np.nan
        return status, measures

    def _slower(self, which):
        """V_lp over V_start of these cases, (n,) or one number."""
        if self.V_start is None:
            return SLOWER
        return (self.batch.flat("V_lp") / self.batch.flat("V_start"))[which]

    def dataset(self, variables):
        """Return these variables of all cases as a Dataset with coordinates and scenario."""
        settings = {"V_lp": self.V_lp, "V_start": self.V_start, "rtol": self.rtol}
        result = xarray.Dataset(variables, self.batch.coordinates(VARIABLES))
        record_scenario(result, "limit_cycle", self.slider, **settings)
        return result

    def refuse_failure(self, result):
        """Raise the exception for a single case without an answer; nothing for a sweep."""
        if self.batch.is_single and (status := int(result.status)) > STEADY_SLIDING:
            best = result if status == NO_CONVERGENCE else None
            raise failure("limit_cycle", self.slider, status, best=best)
