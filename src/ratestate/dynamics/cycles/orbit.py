"""The limit cycle as a curve: one period of it, at the solver's own steps."""

import numpy as np

from ...engine.model import STEADY_SLIDING
from ...model.loading import Loading
from ..progress import bar
from ..refusals import refusal
from ..simulation.simulate import SimulateCall
from .limit_cycle import limit_cycle_call
from .system import state, system_of

# Of the period: its tolerance over that of the cycle, per amplitude of tau/(a sigma); the loosest
# that draws smooth curves, and the tightest that is above rounding.
FINER, LOOSEST, TIGHTEST = 0.1, 1e-7, 1e-13


def orbit(slider, V_lp, *, rtol=1e-8, return_cycle=False):
    """One period of the cycle that `limit_cycle` finds.

    Parameters
    ----------
    slider : SpringSlider
        One slider, no sweep.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], > 0.
    rtol : float
        Relative accuracy of the cycle, from 1e-12 to 1e-2.
    return_cycle : bool
        Whether to return the result of `limit_cycle` too, from the same search.

    Returns
    -------
    xarray.Dataset, or two of these if `return_cycle`
        As from `simulate`, at the solver's own steps along ``time``: ``V`` [m/s], ``theta`` [s],
        ``tau`` [Pa], ``mu`` and the rest.  It begins where V = V_lp and the stress has its
        maximum, and ends there one period later.  For steady sliding it is one point, at time 0.

    Raises
    ------
    ParameterError, QuasiStaticInstability, NotConverged, SolverError
        As `limit_cycle`; also for a sweep.

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
    """One period and the result of `limit_cycle`, two Datasets."""
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
    return _period(slider, call, measures, rtol, progress), cycle


def _period(slider, call, measures, rtol, progress):
    """One period from the section on, as a run."""
    law, columns = slider.friction_law, call.batch.columns
    system, u, V_lp = system_of(law.name, **columns), measures["u"], call.V_lp
    x, _, *psi = state(system, u).T
    states = law.log_states(0.0, tuple(psi), system.coefficients)
    initial = {"V_initial": V_lp}
    for name, distance, log_state in zip(law.states, law.lengths, states, strict=True):
        initial[f"{name}_initial"] = getattr(slider, distance) / V_lp * np.exp(log_state[0])
    if slider.M > 0.0:  # else the stress follows from these
        steady = law.reference_friction(np.array([V_lp]), columns)[0]
        initial["tau_initial"] = slider.sigma * (steady + slider.a * x[0])
    period = measures["period"][0] * slider.Dc / V_lp
    tol = np.clip(FINER * rtol * min(1.0, measures["amplitude"][0]), TIGHTEST, LOOSEST)
    run = SimulateCall(slider, Loading.constant(V_lp), period, initial=initial, rtol=float(tol))
    return run.result(progress)
