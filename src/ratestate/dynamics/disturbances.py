"""The smallest disturbances of steady sliding from which the motion does not come back to it.

Sizes of steps are |ln(V_lp/V)|, those of kicks |change of tau|/(a sigma).
"""

import numpy as np

from ..engine.model import FINISHED, NO_CONVERGENCE, RUNAWAY, STEADY_SLIDING
from ..errors import SolverError
from ..friction.critical_speeds import V_c
from ..friction.quasi_static import EDGES
from ..friction.roots import root
from .cycles.attractor import find_attractors
from .cycles.shooting import return_map
from .cycles.system import small_amplitude, state, steady_sliding_at

#: kinds of disturbances, by number
KINDS = ("step_up", "step_down", "kick_up", "kick_down")
# Sizes tried: smallest, largest, number.
SIZES = np.geomspace(1e-4, 27.6, 96)
#: status of an orbit that does not come back -> its name, "unknown" for any other.  Where a
#: slider's disturbances end in different ways, "unknown" prevails, else the later of these.
OUTCOMES = {FINISHED: "cycle", NO_CONVERGENCE: "irregular cycles", RUNAWAY: "runaway"}
# Then the interval between two sizes is divided into so many parts, until it is this narrow.
PARTS, ACCURACY = 16, 1e-6
# Accuracy of the cycle that is reached, enough to know that it is one; and tolerance of a step of
# the orbit, over the size of the disturbance.
RTOL, ORBIT_RTOL = 1e-5, 2e-9
# Returns after which a motion that has not converged counts as irregular, if its amplitude turns
# back so often, by this part of itself.
RETURNS, TURNS, VISIBLE = 40, 3, 1e-3


def smallest_escapes(system, columns, alone, progress):
    """Smallest sizes (4, n) that leave the basin, the outcome (n,), and u (n, k) of a cycle.

    columns : parameters of the sliders and V_lp, symbol -> (n,) [SI]
    alone : whether SolverError is raised where an edge of runaway cannot be followed
    """
    stable = system.stable & (system.margin != 0.0)
    sizes = np.where(stable, np.inf, 0.0) * np.ones((4, 1))
    outcome = np.where(stable, "none", "no steady sliding").astype("<U17")
    u = _nowhere(system)
    may_leave = stable & system.may_cycle
    if law_edge := EDGES.get(system.friction_law.name):
        for i in np.flatnonzero(may_leave & (system.eta == 0.0)):
            edge = system.kappa[i], system.beta[i], SIZES[-1]
            sizes[:, i], outcome[i] = _runaway(law_edge, edge, alone)
        may_leave &= system.eta > 0.0
    may_leave = np.flatnonzero(may_leave)
    steps = _largest_steps(system, columns)
    slider, kind = np.tile(may_leave, 4), np.repeat(np.arange(4), len(may_leave))
    part = system.at(slider)
    largest = np.where(kind < 2, steps[np.minimum(kind, 1), slider], SIZES[-1])
    smallest, status, ends = _search(part, kind, largest, progress)
    lost = ~np.isin(status, [STEADY_SLIDING, *OUTCOMES])
    unsettled = np.flatnonzero(status == NO_CONVERGENCE)
    if len(unsettled):
        lost[unsettled] = ~_is_irregular(part.at(unsettled), ends[unsettled])
    sizes[:, may_leave] = np.where(lost, np.nan, smallest).reshape(4, -1)
    for code, name in OUTCOMES.items():
        outcome[slider[status == code]] = name
    outcome[slider[lost]] = "unknown"
    cycle = status == FINISHED
    u[slider[cycle]] = ends[cycle]
    return sizes, outcome, u


def _runaway(law_edge, edge, alone):
    """Smallest sizes (4,) that run away without inertia, by the law's own edge, and the outcome.

    Where that cannot be followed, NaN and "unknown", or SolverError for a slider alone.
    """
    try:
        step_up, *kicks = law_edge(*edge)
    except SolverError:
        if alone:
            raise
        return np.nan, "unknown"
    sizes = np.array([step_up, np.inf, *kicks])
    return sizes, "runaway" if np.isfinite(sizes).any() else "none"


def _search(system, kind, largest, progress):
    """Sizes (n,) of the smallest disturbances of these kinds (n,) that leave the basin, or inf.

    Also the status with which the orbits end, and their u (n, k) if on a cycle.

    largest : (n,) largest size to try
    """
    n = len(kind)
    low, high = np.zeros(n), np.full(n, np.inf)
    status, u = np.full(n, STEADY_SLIDING), _nowhere(system)
    trial, which = np.minimum(SIZES, largest[:, None]), np.arange(n)
    while len(which):
        m = trial.shape[1]
        part = system.at(np.repeat(which, m))
        start = _disturbed(part, np.repeat(kind[which], m), trial.ravel())
        loosest = ORBIT_RTOL * np.clip(trial.ravel(), 1e-5, 1.0)
        attractors = find_attractors(part, start, RTOL, progress, loosest)
        leaves = (attractors.status != STEADY_SLIDING).reshape(-1, m)
        first, some = leaves.argmax(axis=1), leaves.any(axis=1)
        row = np.arange(len(which))
        last = np.where(some, first, m) - 1
        low[which] = np.where(last < 0, low[which], trial[row, last])
        at, cell = which[some], row[some] * m + first[some]
        high[at], status[at] = trial[some, first[some]], attractors.status[cell]
        u[at] = attractors.u[cell]
        which = np.flatnonzero(np.isfinite(high) & (high - low > ACCURACY * high))
        gap = high[which] - low[which]
        trial = low[which, None] + gap[:, None] * np.arange(1, PARTS) / PARTS
    return high, status, u


def _is_irregular(system, u):
    """(n,) whether amplitudes on motions from u (n, k) go up and down.

    Else a search that did not converge says nothing: a motion may be slow.
    """
    amplitudes = np.empty((RETURNS, len(u)))
    for amplitude in amplitudes:
        amplitude[:] = small_amplitude(system, u)
        u = return_map(system, state(system, u), np.full(len(u), ORBIT_RTOL)).image
    changes = np.diff(amplitudes, axis=0) / amplitudes[:-1]
    visible = np.abs(changes[1:]) > VISIBLE
    return ((changes[1:] * changes[:-1] < 0.0) & visible).sum(axis=0) >= TURNS


def _disturbed(system, kind, size):
    """(n, len(y)) x, v, psi right after disturbances of these kinds (n,) and sizes (n,)."""
    sign = np.where(kind % 2 == 0, 1.0, -1.0)
    y = steady_sliding_at(system, np.where(kind < 2, np.exp(-sign * size), 1.0))
    y[:, 0] += np.where(kind < 2, 0.0, sign * size)
    at_once = (kind >= 2) & (system.eta == 0.0)  # without mass friction follows the stress
    law, psi, p = system.friction_law, tuple(y[:, 2:].T), system.coefficients

    def off(v):
        return law.at(v, psi, p).S - y[:, 0]

    y[:, 1] = np.where(at_once, root(off, y[:, 1], at_once), y[:, 1])
    return y


def _largest_steps(system, columns):
    """(2, n) ln of the largest step up and down that leads from stable steady sliding to V_lp.

    Up from V_c_upper, where V_lp is above it; down from V_c, where V_lp is below it.

    columns : parameters of the sliders and V_lp, symbol -> (n,) [SI]
    """
    names = (*system.friction_law.symbols, "sigma", "K", "M")
    lower, upper = V_c(system.friction_law, **{name: columns[name] for name in names})
    V_lp, farthest = columns["V_lp"], SIZES[-1]
    with np.errstate(divide="ignore"):  # V_c may be 0 or inf
        up = np.where(V_lp > upper, np.log(V_lp / upper), np.inf)
        down = np.where(V_lp < lower, np.log(lower / V_lp), np.inf)
    return np.minimum([up, down], farthest)


def _nowhere(system):
    """(n, k) points of the section that are unknown."""
    return np.full((len(system.kappa), 1 + len(system.friction_law.states)), np.nan)
