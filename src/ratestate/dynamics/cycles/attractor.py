"""Which attractor a slider reaches from a given start: a limit cycle or steady sliding.

Where steady sliding and cycles coexist, the answer depends on the start.  So the search follows
the orbit itself from the start, and estimates where it goes (search_step.py).  Near steady sliding,
where the return map drowns in rounding, harmonic balance takes over.
"""

from typing import NamedTuple

import numpy as np

from ...engine.model import FINISHED, NO_CONVERGENCE, RUNNING, STEADY_SLIDING
from .iterates import iterated_map
from .search_step import LARGEST_LEAP, LOOSEST, advance_search, search_type
from .shooting import return_map
from .small_cycles import hopf_curvature, small_cycle
from .system import distance, select, small_amplitude, steady_sliding_at, tightest

# Steps of the search, and returns of an orbit, after which a slider counts as never converging.
MAX_SEARCH_STEPS, MAX_RETURNS = 400, 2000
# A cycle that closes to this distance, divided by its own from u = 0, after half its returns is one
# of half as many.
CLOSES = 1e-4
# Amplitude of ln V below which a stable steady sliding is reached; and below which a cycle is
# small enough for harmonic balance.
STEADY, SMALL = 1e-2, 2e-2
# Below this one no unstable cycle is looked for beside stable steady sliding.
SMALLEST = 1e-5
# V_lp over the speed of the steady sliding from which a search starts, unless asked otherwise.
SLOWER = 10.0
# Loosest relative accuracy of a cycle: a looser one would not be cheaper.
LOOSEST_ANSWER = 1e-5


class CycleEstimates(NamedTuple):
    """A point on the section for each of n sliders, where its limit cycle is thought to be.

    `find_attractors` returns the attractor that each slider has reached.
    """

    status: np.ndarray  # engine.model: FINISHED is a cycle
    #: (n, k) the cycle's stress maximum; without a cycle, the orbit's last one, or NaN where it did
    #: not come back to the section
    u: np.ndarray
    tol: np.ndarray  # (n,) tolerance of the return that led there
    period: np.ndarray  # (n,) [Dc/V_lp]; without a cycle, the time of the last returns
    error: np.ndarray  # (n,) estimated relative error if known, as of a small cycle; else 0
    n_returns: np.ndarray  # (n,) how many returns make the period

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return select(self, which)


def single_returns(u, tol, period, error=0.0, status=FINISHED):
    """`CycleEstimates` of cycles that close after one return.

    u : (n, k); tol, period : (n,); error, status : (n,), or one value for all
    """
    n = len(u)
    values = np.full(n, status), u, tol, period, np.full(n, error), np.ones(n, np.int64)
    return CycleEstimates(*values)


def steady_start(system, slower=SLOWER):
    """(n, len(y)) x, v, psi from which a search starts: steady sliding at V_lp/slower."""
    return steady_sliding_at(system, np.full(len(system.kappa), 1.0 / slower))


def find_attractors(system, start, rtol, progress, loosest=LOOSEST):
    """Follow n > 0 sliders from the states start (n, len(y)) to their attractors; `CycleEstimates`.

    Each step of the search is one return of all orbits that have not arrived, or as many as make
    the period that the orbit seems to have.  An orbit has arrived where Newton's method, or near
    the Hopf point harmonic balance, has found the cycle that attracts it (FINISHED), and near
    stable steady sliding (STEADY_SLIDING).  One that does not come back to the section keeps the
    status of that return; one still under way after MAX_RETURNS returns or MAX_SEARCH_STEPS steps
    of the search is given up (NO_CONVERGENCE).

    rtol : relative accuracy of the cycle; at most 1e-5 is used
    progress : callable or None, given the fraction of sliders whose search is over
    loosest : (n,) largest tolerance of a return; the orbit itself is followed at least this closely
    """
    n = len(start)
    rtol, loosest = min(rtol, LOOSEST_ANSWER), np.broadcast_to(loosest, n)
    stable = system.stable
    steady_tol = np.where(stable, 1e-6, 0.0)
    first = return_map(system, start, loosest, steady_tol=steady_tol)
    status = np.where(first.came_back, RUNNING, first.status)
    period = first.numbers["period"]
    estimates = single_returns(first.image.copy(), loosest.astype(float), period, status=status)
    search, followed = np.zeros(n, search_type(start.shape[1] - 1)), np.ones(n, np.int64)
    balance_untried = ~stable
    search["longest"] = LARGEST_LEAP
    for number in range(MAX_SEARCH_STEPS):
        active = np.flatnonzero((estimates.status == RUNNING) & (followed < MAX_RETURNS))
        if progress:
            progress(1.0 - len(active) / n)
        if not len(active):
            break
        part, current, searching = system.at(active), estimates.at(active), search[active]
        options = {"steady_tol": steady_tol[active]}
        returns = iterated_map(part, current.u, current.tol, current.n_returns, **options)
        followed[active] += current.n_returns
        on_orbit = returns.came_back & ~searching["ahead"]
        r = np.where(on_orbit, small_amplitude(part, current.u), np.inf)
        estimates.status[active] = np.where(returns.came_back, RUNNING, returns.status)
        estimates.period[active] = returns.numbers["period"]
        estimates.u[active], estimates.tol[active], converged, doubled = advance_search(
            part, returns, current, searching, rtol, loosest[active], leap=number > 0
        )
        estimates.n_returns[active[doubled]] *= 2
        search[active] = searching
        estimates.status[active[converged]] = FINISHED
        _finish_at_rest(system, estimates, active, np.where(stable[active], r, np.inf))
        small = active[balance_untried[active] & (r < SMALL)]
        _finish_on_small_cycles(system, estimates, small)
        balance_untried[small] = False
    estimates.status[estimates.status == RUNNING] = NO_CONVERGENCE
    _halve_periods(system, estimates)
    return estimates


def _halve_periods(system, estimates):
    """Halve the returns of a cycle as long as it closes after half of them already."""
    which = np.flatnonzero((estimates.status == FINISHED) & (estimates.n_returns > 1))
    while len(which):
        part, cycles = system.at(which), estimates.at(which)
        half = iterated_map(part, cycles.u, cycles.tol, cycles.n_returns // 2)
        closes = distance(part, half.image - cycles.u) <= CLOSES * distance(part, cycles.u)
        which = which[closes]
        estimates.n_returns[which] //= 2
        estimates.period[which] *= 0.5
        which = which[estimates.n_returns[which] > 1]


def _finish_at_rest(system, estimates, active, r):
    """Mark as steady sliding those of the active sliders whose amplitude r is small enough.

    Beside stable sliding, only unstable cycles are that small; an orbit inside them spirals in.
    """
    which, r = active[r < STEADY], r[r < STEADY]
    if len(which):
        part = system.at(which)
        inside = (part.margin > hopf_curvature(part) * r**2) | (r < SMALLEST)
        estimates.status[which[inside]] = STEADY_SLIDING


def _finish_on_small_cycles(system, estimates, which):
    """Put the small cycles of these sliders into the estimates, where harmonic balance has one."""
    if not (len(which) and system.friction_law.one_length):
        return
    part = system.at(which)
    cycles = small_cycle(part.law, part.kappa, part.beta, part.eta)
    near = cycles.valid & (cycles.r < 2.0 * SMALL)
    which, cycles = which[near], select(cycles, near)
    estimates.status[which] = FINISHED
    estimates.u[which] = np.stack([cycles.psi, cycles.G], axis=1)
    estimates.period[which] = 2.0 * np.pi / cycles.omega
    estimates.error[which] = cycles.error
    estimates.tol[which] = tightest(system.at(which), estimates.u[which])
