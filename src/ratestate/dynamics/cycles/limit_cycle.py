"""The functions `limit_cycle` and `orbit`: the attractor of a steadily driven slider."""

import dataclasses
import functools
from typing import Any

import numpy as np

from ...engine.model import FINISHED, NO_CONVERGENCE, STEADY_SLIDING
from ...friction.linear_stability import is_stable
from ...model.arrays import Batch
from ...model.initial_state import check_speed_ratio
from ...model.loading import Loading
from ...model.names import keywords_checked
from ...model.slider import check_slider
from ...model.units import to_si
from ..progress import bar
from ..refusals import refusal
from ..results import CheckedCall, columns, domain_variables, status_variable
from ..simulation.engine_cases import failure
from ..simulation.settings import checked_rtol
from ..simulation.simulate import SimulateCall
from .attractor import SLOWER, find_attractors, steady_start
from .measure import refine
from .system import state, system_of

#: variables of a run that `orbit` takes from the cycle
OF_PERIOD = "amplitude", "stress_drop", "frequency", "returns"
#: names of the result, which a dimension or coordinate of the sweep cannot have
VARIABLES = (
    "period frequency amplitude stress_drop V_max V_min inertia slow_fraction fundamental"
    " multipliers multipliers_error multiplier stable residual error V_max_error V_min_error"
    " returns mu_min reversal_margin outside_domain status"
).split()
# Relative error beyond which an answer is refused.
WORST = 1e-2
# Sliders at a time: enough to fill every lane, few enough to hold in memory.
CHUNK = 1 << 15
# Tolerance of an orbit divided by rtol of the cycle and its amplitude of tau/(a sigma); the loosest
# that draws smooth curves, and the tightest that is above rounding.
FINER, LOOSEST, TIGHTEST = 0.1, 1e-7, 1e-13


@keywords_checked
def limit_cycle(slider, V_lp, *, V_start=None, rtol=1e-8):
    """Find the cycle that a slider reaches from steady sliding at V_start.

    If several cycles or steady sliding are possible, the result is the motion that is reached from
    this start.  If stress maxima alternate, the cycle closes after 2, 4, ... maxima (period
    doubling).

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity [m/s], > 0.
    V_start : float, str, pint.Quantity or DataArray, optional
        The motion starts in steady sliding at this slip velocity [m/s], > 0 and not V_lp.  The
        default is V_lp/10.  Another start may lead to another cycle.  Without mass, a start nearer
        to V_lp may avoid a runaway.
    rtol : float
        Relative accuracy of amplitude and period, from 1e-12 to 1e-2.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions:

        - ``period`` [s] and ``frequency`` [Hz];
        - ``amplitude`` (max - min of tau/sigma) and ``stress_drop`` [Pa] (max - min of tau);
        - ``V_max`` and ``V_min``: largest and smallest slip velocity [m/s];
        - ``inertia``: max |tau/sigma - mu| divided by the amplitude;
        - ``slow_fraction``: the part of the period in which V < V_lp/10;
        - ``fundamental``: the share of the variance of tau that the harmonic with one oscillation
          per stress maximum has.  It is 1 for a sine and 6/pi^2 for a sawtooth;
        - ``multipliers``: complex Floquet multipliers without the trivial 1, largest first, in the
          dimension ``multiplier``.  Small distances from the cycle change by these factors in a
          period.  Their number is one more than the number of the law's states.  If they are below
          1e-8, only their product is accurate;
        - ``multipliers_error``: estimated absolute error of each multiplier.  With cut-offs it may
          exceed rtol;
        - ``stable``: whether small disturbances decay;
        - ``mu_min`` and ``reversal_margin``: smallest mu, and smallest tau/sigma + mu;
        - ``outside_domain`` (int8 with CF flags): whether the motion leaves the domain of the
          friction law.  If mu_min is negative, friction would have to push.  If reversal_margin is
          negative, the spring pulls back harder than friction can hold;
        - ``residual``: relative distance by which the cycle fails to close;
        - ``error``: estimated relative error of amplitude and period.  It includes the effect of
          rounding of the parameters, which is large if the cycle changes abruptly with a parameter;
        - ``V_max_error`` and ``V_min_error``: estimated relative errors of the speeds.  They may
          exceed rtol if speeds span decades.  V_min below 1e-260 V_lp counts as rest;
        - ``returns``: number of stress maxima in the period: 1, 2, 4, ... 32, or 0 without a cycle;
        - ``status`` (int8 with CF flags): 0 is a cycle, 1 is steady sliding.  In steady sliding
          amplitude, stress_drop, inertia, slow_fraction, residual and their errors are 0,
          V_max = V_min = V_lp, and stable is True.  Period, frequency, fundamental and multipliers
          are NaN.

    Raises
    ------
    ParameterError
        If an argument cannot be used.
    QuasiStaticInstability
        If M = 0 and the slip velocity grows without bound in a finite time.
    NotConverged
        If the motion does not settle into a cycle of 1, 2, 4, ... 32 maxima, or if double precision
        limits its accuracy to worse than 1 %.  The attribute ``best`` holds the last period that
        was computed.
    SolverError
        If the search fails for another reason.  In a sweep no error is raised: such cases are NaN
        (stable False, returns 0, outside_domain -1), and their status is the reason.

    Notes
    -----
    The method is shooting: Newton's method on the return map of the section V = V_lp at stress
    maxima.  The derivative of the map comes from the variational equations.

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
    """Return the `LimitCycleCall` with these arguments of `limit_cycle`, checked one by one."""
    rtol = checked_rtol(rtol, "1e-12", "1e-2", "1e-8")
    V_lp = to_si("V_lp", V_lp)
    if V_start is not None:
        V_start = to_si("V_start", V_start)
        if np.any(V_start == V_lp):
            raise refusal("cycles.undisturbed")
    return LimitCycleCall(check_slider(slider), V_lp, V_start, rtol)


@dataclasses.dataclass(frozen=True, eq=False)
class LimitCycleCall(CheckedCall):
    """`limit_cycle` with its arguments, checked and in SI."""

    V_lp: Any
    V_start: Any  # None for the usual one
    rtol: float
    function, names = "limit_cycle", VARIABLES

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, V_lp and V_start.

        Raises ParameterError if dimensions or coordinates clash with each other or with the
        result's, and if V_start is beyond 1e-260 or 1e260 times V_lp.
        """
        start = {} if self.V_start is None else {"V_start": self.V_start}
        batch = Batch({**self.slider.values, "V_lp": self.V_lp, **start}, reserved=VARIABLES)
        if start:
            speeds = batch.flat("V_start"), "V_lp", batch.flat("V_lp")
            check_speed_ratio(self.slider.friction_law, "V_start", *speeds)
        return batch

    def blank(self):
        return self.variables(np.full(self.batch.n, NO_CONVERGENCE), {})

    def run(self, progress=None):
        """Return the variables, name -> Variable in the dimensions of the sweep.

        A case without a cycle raises no error: it has its status.
        """
        return self.variables(*self.find_cycles(progress))

    def variables(self, status, measures):
        """Return the variables of `run` from the results of `find_cycles`."""
        # An attractor is stable, though the multipliers of the smallest cycles round to 1.
        stable = status == FINISHED
        return cycle_variables(self.slider.friction_law, self.batch, status, measures, stable)

    def find_cycles(self, progress=None):
        """Return the status (n,) of all cases, and the measures of their cycles as by `refine`.

        Measures are NaN if the status is not a cycle, except for a single case that has not
        converged.  They are {} if no case can have a cycle (K = inf, or steady sliding stable at
        any K).
        """
        n, is_single = self.batch.n, self.batch.is_single
        system = system_of(self.slider.friction_law.name, **self.batch.columns)
        status = np.full(n, STEADY_SLIDING)
        may_cycle = np.flatnonzero(system.may_cycle)
        slower = np.full(n, SLOWER)
        if self.V_start is not None:
            slower = self.batch.flat("V_lp") / self.batch.flat("V_start")
        measures: dict = {}
        for first in range(0, len(may_cycle), CHUNK):
            rows = may_cycle[first : first + CHUNK]
            part = system.at(rows)
            done, share = first / len(may_cycle), len(rows) / len(may_cycle)
            advance = progress and (lambda x, d=done, s=share: progress(d + s * x))
            start = steady_start(part, slower[rows])
            attractors = find_attractors(part, start, self.rtol, advance)
            status[rows] = attractors.status
            cycle = attractors.status == FINISHED
            cycle |= is_single & (attractors.status == NO_CONVERGENCE)
            values = refine(part.at(cycle), attractors.at(cycle), self.rtol)
            for name, value in values.items():
                empty = np.full((n, *value.shape[1:]), np.nan, value.dtype)
                measures.setdefault(name, empty)[rows[cycle]] = value
        if measures:
            # A cycle that proves to be unstable is not the attractor.
            valid = (measures["error"] <= WORST) & (np.abs(measures["multipliers"][:, 0]) < 1.0)
            is_doubtful = (status == FINISHED) & ~valid
            status[is_doubtful] = NO_CONVERGENCE
            for value in () if is_single else measures.values():
                value[is_doubtful] = np.nan
        return status, measures

    def refuse_failure(self, result):
        """Raise the exception for a single case without an answer; a sweep raises none."""
        if self.batch.is_single and (status := int(result.status)) > STEADY_SLIDING:
            best = result if status == NO_CONVERGENCE else None
            raise failure("limit_cycle", self.slider, status, best=best)


def cycle_variables(law, batch, status, measures, stable):
    """Return the variables of `limit_cycle`, name -> Variable [SI], from measures of cycles.

    batch : of the sliders and V_lp
    measures : as from `measure`, name -> (n,) or (n, k), NaN without a cycle; or empty
    stable : (n,) whether the cycles are stable
    """
    p, V, steady = columns(batch), batch.flat("V_lp"), status == STEADY_SLIDING
    missing = np.full(batch.n, np.nan)

    def measured(name, if_steady=np.nan):
        return np.where(steady, if_steady, measures.get(name, missing))

    period, amplitude = measured("period") * p.Dc / V, measured("amplitude", 0.0)
    at_V, psi = law.coefficient_arrays(V, batch.columns), law.reference_state
    steady_v = law.v_at(1.0, psi, at_V)
    of_law = {symbol: batch.flat(symbol) for symbol in law.symbols}
    steadily = is_stable(law, V, sigma=p.sigma, K=p.K, M=p.M, **of_law)
    with np.errstate(divide="ignore", invalid="ignore"):
        values = {
            "period": period,
            "frequency": 1.0 / period,
            "amplitude": p.a * amplitude,
            "stress_drop": p.sigma * (p.a * amplitude),
            "V_max": V * law.speed(measured("v_max", steady_v), psi, at_V),
            "V_min": V * law.speed(measured("v_min", steady_v), psi, at_V),
            "inertia": np.where(steady, 0.0, measured("g_max") / amplitude),
            "slow_fraction": measured("slow_fraction", 0.0),
            "fundamental": measured("fundamental"),
            "stable": np.where(steady, steadily, stable),
            "residual": measured("residual", 0.0),
            "error": measured("error", 0.0),
            "V_max_error": measured("v_max_error", 0.0),
            "V_min_error": measured("v_min_error", 0.0),
            "returns": np.nan_to_num(measured("returns", 0.0)).astype(np.int16),
        }
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    mu = law.reference_friction(V, batch.columns)
    at = law.steady(at_V)
    lowest = mu + p.a * measured("f_min", at.R), 2.0 * mu + p.a * measured("xf_min", at.R + at.S)
    variables |= domain_variables(law, batch, *lowest)
    missing_vectors = np.full((batch.n, 1 + len(law.states)), np.nan)
    for name, dtype in (("multipliers", complex), ("multipliers_error", float)):
        value = measures.get(name, missing_vectors.astype(dtype))
        variables[name] = batch.variable(value, name, "multiplier")
    return variables | {"status": status_variable(batch, status)}


def orbit(slider, V_lp, *, rtol=1e-8, return_cycle=False):
    """Compute one period of the cycle that `limit_cycle` finds.

    Parameters
    ----------
    slider : SpringSlider
        One slider, not a sweep.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], > 0.
    rtol : float
        Relative accuracy of the cycle, from 1e-12 to 1e-2.
    return_cycle : bool
        Whether to return the result of `limit_cycle` too, from the same search.

    Returns
    -------
    xarray.Dataset, or two of these if `return_cycle`
        The variables of `simulate` along ``time``, at the solver's own steps: ``V`` [m/s],
        ``theta`` [s], ``tau`` [Pa], ``mu`` and others.  The orbit begins at the maximum of the
        stress, where V = V_lp, and ends there one period later.  Steady sliding is one point, at
        time 0.  The values of amplitude, stress_drop, frequency and returns are taken from the
        result of `limit_cycle`, and ``cycles`` is 1.  In steady sliding all of these are 0.  The
        attributes are from `simulate`.

    Raises
    ------
    ParameterError, QuasiStaticInstability, NotConverged, SolverError
        As from `limit_cycle`.  ParameterError also if the slider is a sweep.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> run = orbit(slider, "3.2 mm/s")
    >>> round(float(run.time[-1]), 5)  # s, the period
    0.01976
    """
    with bar("orbit") as progress:
        run, cycle = _run_and_cycle(slider, V_lp, rtol, progress)
    return (run, cycle) if return_cycle else run


def _run_and_cycle(slider, V_lp, rtol, progress):
    """Return one period and the result of `limit_cycle`, two Datasets."""
    call = limit_cycle_call(slider, V_lp, rtol=rtol)
    if not call.batch.is_single:
        dims = ", ".join(map(str, call.batch.dims))
        raise refusal("cycles.orbit_of_sweep", slider=slider, dims=dims)
    status, measures = call.find_cycles(progress)
    cycle = call.dataset(call.variables(status, measures))
    call.refuse_failure(cycle)
    if status[0] == STEADY_SLIDING:
        loading, time = Loading.constant(call.V_lp), slider.Dc / call.V_lp
        return SimulateCall(slider, loading, time, times=np.zeros(1)).result(), cycle
    run = _period(slider, call, measures, rtol, progress)
    # A run of one period ends before it has measured a period.
    measured = {name: cycle[name] for name in OF_PERIOD} | {"cycles": 1.0}
    return run.assign({name: run[name].copy(data=measured[name]) for name in measured}), cycle


def _period(slider, call, measures, rtol, progress):
    """Simulate one period from the section on."""
    law, columns = slider.friction_law, call.batch.columns
    system, u, V_lp = system_of(law.name, **columns), measures["u"], call.V_lp
    x, _, *psi = state(system, u).T
    states = law.log_states(0.0, tuple(psi), system.coefficients)
    initial = {"V_initial": V_lp}
    for name, distance, log_state in zip(law.states, law.lengths, states, strict=True):
        initial[f"{name}_initial"] = getattr(slider, distance) / V_lp * np.exp(log_state[0])
    if slider.M > 0.0:  # else these determine the stress
        steady = law.reference_friction(np.array([V_lp]), columns)[0]
        initial["tau_initial"] = slider.sigma * (steady + slider.a * x[0])
    period = measures["period"][0] * slider.Dc / V_lp
    tol = np.clip(FINER * rtol * min(1.0, measures["amplitude"][0]), TIGHTEST, LOOSEST)
    run = SimulateCall(slider, Loading.constant(V_lp), period, initial=initial, rtol=float(tol))
    return run.result(progress)
