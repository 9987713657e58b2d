"""The basin of stable steady sliding: the disturbances from which the motion returns to it.

Small disturbances decay where K > K_c, but large ones need not if a limit cycle coexists, or a
runaway without inertia.  `escape` finds the smallest ones that do not decay, of two kinds that a
laboratory can impose.  With inertia it follows the motion itself, and adds the unstable cycle that
lies between.  Without inertia, under the slip and aging laws, it uses the path that separates
runaways from orbits that come back (`quasi_static`); under other laws it follows the motion.
"""

import numpy as np

from ..engine.model import FINISHED, NO_CONVERGENCE, RUNAWAY, STEADY_SLIDING
from ..errors import SolverError
from ..friction.critical_speeds import V_c
from ..friction.quasi_static import EDGES
from ..friction.roots import root
from ..model.arrays import Batch
from ..model.slider import check_slider
from ..model.units import to_si
from .continuation.family import CycleFamily
from .cycles.attractor import find_attractors
from .cycles.measure import refine
from .cycles.shooting import return_map
from .cycles.system import small_amplitude, state, steady_sliding_at, system_of
from .progress import bar
from .recipe import recorded_result
from .results import columns

#: kinds of disturbances, by number; a step has the size |ln(V_lp/V)|, a kick
#: |change of tau|/(a sigma)
KINDS = ("step_up", "step_down", "kick_up", "kick_down")
#: measures of the limit cycle beyond, and of the unstable one between
CYCLES = ("amplitude", "period", "unstable_amplitude", "unstable_period", "unstable_multiplier")
VARIABLES = [*KINDS, "outcome", *CYCLES]
#: status of an orbit that does not come back -> its name, "unknown" for any other.  If a slider's
#: disturbances end in different ways, "unknown" prevails, else the later of these.
OUTCOMES = {FINISHED: "cycle", NO_CONVERGENCE: "irregular cycles", RUNAWAY: "runaway"}
# Accuracy of the cycles whose measures are returned; and the stiffness, as a multiple of the
# slider's, by which the two must have met.
CYCLE_RTOL, FARTHEST_FOLD = 1e-8, 100.0
# Sizes tried: smallest, largest, number.
SIZES = np.geomspace(1e-4, 27.6, 96)
# Then the interval between two sizes is divided into so many parts, until it is this narrow.
PARTS, ACCURACY = 16, 1e-6
# Accuracy of the cycle that is reached, enough to know that it is one; and tolerance of a step of
# the orbit, divided by the size of the disturbance.
RTOL, ORBIT_RTOL = 1e-5, 2e-9
# Returns after which a motion that has not converged counts as irregular, if its amplitude turns
# back so often, by this part of itself.
RETURNS, TURNS, VISIBLE = 40, 3, 1e-3


def escape(slider, V_lp):
    """Find the smallest disturbances of steady sliding at V_lp that do not decay.

    There are two kinds of disturbance.  In a step, the slider slides steadily at another speed, at
    which steady sliding is stable, until the load point's speed changes to V_lp.  In a kick, the
    spring's stress changes suddenly while the slider slides steadily at V_lp.  A disturbance decays
    if the slider slides steadily in the end, however fast it slides before.

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    V_lp : float, str, pint.Quantity or DataArray
        Load-point velocity [m/s], > 0.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions:

        - ``step_up`` > 1 and ``step_down`` < 1: V_lp divided by the speed before the smallest
          step; inf and 0 if every step of up to 12 decades decays; 1 if steady sliding at V_lp is
          unstable (K <= K_c);
        - ``kick_up`` > 0 and ``kick_down`` < 0: smallest change of tau [Pa]; inf and -inf if every
          change of up to 27 a sigma decays; 0 if steady sliding is unstable;
        - ``outcome``: the motion after such a disturbance.  "cycle", "irregular cycles" that do not
          repeat, "runaway" (M = 0), "none" if all disturbances decay, or "no steady sliding" if it
          is unstable.  It is "irregular cycles" if any of the four disturbances leads to them;
        - ``amplitude`` (max - min of tau/sigma) and ``period`` [s] of the limit cycle reached; NaN
          unless the outcome is "cycle", also if steady sliding is unstable;
        - ``unstable_amplitude``, ``unstable_period`` [s] and ``unstable_multiplier`` of the
          unstable cycle that separates it from steady sliding.  In a period a small distance from
          this cycle is multiplied by unstable_multiplier.  NaN if there is no such cycle.

    Raises
    ------
    ParameterError
        If an argument cannot be used, or if the law has no second derivatives.
    SolverError
        If a motion cannot be followed to its end or does not settle.  In a sweep no error is
        raised: the outcome is "unknown", and the size is NaN.

    Notes
    -----
    The speed before a step must also be one at which steady sliding is stable.  If V_lp is below
    V_c, only speeds below V_c are tried.  If it is above V_c_upper, only speeds above V_c_upper.

    Examples
    --------
    Without inertia a large step leads to a runaway.

    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="630 MPa/m", M=0)
    >>> edge = rs.escape(slider, "1 um/s")
    >>> str(edge.outcome.values), round(float(edge.step_up), 2)
    ('runaway', 2.11)
    """
    V_lp = to_si("V_lp", V_lp)
    batch = Batch({**check_slider(slider).values, "V_lp": V_lp}, reserved=VARIABLES)
    batch.check_fits(len(VARIABLES), "Ask for fewer at a time.")
    system = system_of(slider.friction_law.name, **batch.columns)
    is_single = batch.shape == ()
    with bar("escape") as progress:
        sizes, outcome, u = _smallest_escapes(system, batch.columns, is_single, progress)
    if is_single and outcome[0] == "unknown":
        raise SolverError(f"an orbit from disturbed sliding could not be followed\n{slider!r}")
    cycles = _cycles_around(system, batch.columns, np.flatnonzero(outcome == "cycle"), u)
    p = columns(batch)
    units = {"amplitude": p.a, "period": p.Dc / p.V_lp, "multiplier": 1.0}
    with np.errstate(over="ignore"):
        values = {
            "step_up": np.exp(sizes[0]),
            "step_down": np.exp(-sizes[1]),
            "kick_up": p.a * p.sigma * sizes[2],
            "kick_down": 0.0 - p.a * p.sigma * sizes[3],
        }
        for name, value in cycles.items():
            values[name] = units[name.removeprefix("unstable_")] * value
    values["outcome"] = outcome
    variables = {name: batch.variable(value, name) for name, value in values.items()}
    return recorded_result("escape", slider, batch, variables, VARIABLES, V_lp=V_lp)


def _cycles_around(system, columns, rows, u):
    """Return the measures `CYCLES` of these sliders, name -> (n,).

    As the stiffness increases the two cycles meet in a fold: the branch from the stable cycle comes
    back to the slider's own stiffness as the unstable one.

    columns : parameters of the sliders and V_lp, symbol -> (n,) [SI]
    u : (n, k) near the stable cycles
    """
    result = {name: np.full(len(u), np.nan) for name in CYCLES}
    part = system.at(rows)
    attractors = find_attractors(part, state(part, u[rows]), CYCLE_RTOL, None)
    stable = refine(part, attractors, CYCLE_RTOL)
    result["amplitude"][rows], result["period"][rows] = stable["amplitude"], stable["period"]
    single = attractors.n_returns == 1  # as of the unstable cycle that meets it
    for i, u_i in zip(rows[single], attractors.u[single], strict=True):
        values = {symbol: float(column[i]) for symbol, column in columns.items()}
        family, p = CycleFamily(system.law, values, "K", CYCLE_RTOL), np.log(values["K"])
        branch = family.branch(family.chart(u_i[None], p)[0], p, stop=p + np.log(FARTHEST_FOLD))
        # Close to the Hopf point p hardly changes along the branch, and noise hides the solution at
        # exactly the first p.
        if len(branch.points) > 2 and abs(branch.points[-1].p - p) <= CYCLE_RTOL:
            measures = family.measures(branch.points[-1:], {"start": values["K"]})
            result["unstable_amplitude"][i] = measures["amplitude"][0]
            result["unstable_period"][i] = measures["period"][0]
            result["unstable_multiplier"][i] = measures["multipliers"][0, 0].real
    return result


def _smallest_escapes(system, columns, is_single, progress):
    """Return the smallest sizes (4, n) that leave the basin, the outcome, and u of a cycle.

    is_single : whether SolverError is raised if an edge of runaway cannot be followed
    """
    stable = system.stable & (system.margin != 0.0)
    sizes = np.where(stable, np.inf, 0.0) * np.ones((4, 1))
    outcome = np.where(stable, "none", "no steady sliding").astype("<U17")
    u = _unknown_points(system)
    may_leave = stable & system.may_cycle
    if law_edge := EDGES.get(system.friction_law.name):
        for i in np.flatnonzero(may_leave & (system.eta == 0.0)):
            edge = system.kappa[i], system.beta[i], SIZES[-1]
            sizes[:, i], outcome[i] = _runaway(law_edge, edge, is_single)
        may_leave &= system.eta > 0.0
    may_leave = np.flatnonzero(may_leave)
    steps = _largest_steps(system, columns)
    slider, kind = np.tile(may_leave, 4), np.repeat(np.arange(4), len(may_leave))
    part = system.at(slider)
    largest = np.where(kind < 2, steps[np.minimum(kind, 1), slider], SIZES[-1])
    smallest, status, ends = _search(part, kind, largest, progress)
    is_unknown = ~np.isin(status, [STEADY_SLIDING, *OUTCOMES])
    unsettled = np.flatnonzero(status == NO_CONVERGENCE)
    if len(unsettled):
        is_unknown[unsettled] = ~_is_irregular(part.at(unsettled), ends[unsettled])
    sizes[:, may_leave] = np.where(is_unknown, np.nan, smallest).reshape(4, -1)
    for code, name in OUTCOMES.items():
        outcome[slider[status == code]] = name
    outcome[slider[is_unknown]] = "unknown"
    cycle = status == FINISHED
    u[slider[cycle]] = ends[cycle]
    return sizes, outcome, u


def _runaway(law_edge, edge, is_single):
    """Return the smallest sizes (4,) that run away without inertia, by the law's own edge.

    Also returns the outcome, which is "unknown" if the edge cannot be followed.
    """
    try:
        step_up, *kicks = law_edge(*edge)
    except SolverError:
        if is_single:
            raise
        return np.nan, "unknown"
    sizes = np.array([step_up, np.inf, *kicks])
    return sizes, "runaway" if np.isfinite(sizes).any() else "none"


def _search(system, kind, largest, progress):
    """Return the sizes (n,) of the smallest disturbances of these kinds that leave the basin.

    A size is inf if none does.  Also returns the status with which the orbits end, and their u.

    largest : (n,) largest size to try
    """
    n = len(kind)
    low, high = np.zeros(n), np.full(n, np.inf)
    status, u = np.full(n, STEADY_SLIDING), _unknown_points(system)
    trial, rows = np.minimum(SIZES, largest[:, None]), np.arange(n)
    while len(rows):
        m = trial.shape[1]
        part = system.at(np.repeat(rows, m))
        start = _disturbed(part, np.repeat(kind[rows], m), trial.ravel())
        loosest = ORBIT_RTOL * np.clip(trial.ravel(), 1e-5, 1.0)
        attractors = find_attractors(part, start, RTOL, progress, loosest)
        leaves = (attractors.status != STEADY_SLIDING).reshape(-1, m)
        first, has_left = leaves.argmax(axis=1), leaves.any(axis=1)
        row, inside = np.arange(len(rows)), np.where(has_left, first, m) - 1
        low[rows] = np.where(inside < 0, low[rows], trial[row, inside])
        at, cell = rows[has_left], row[has_left] * m + first[has_left]
        high[at], status[at] = trial[has_left, first[has_left]], attractors.status[cell]
        u[at] = attractors.u[cell]
        rows = np.flatnonzero(np.isfinite(high) & (high - low > ACCURACY * high))
        gap = high[rows] - low[rows]
        trial = low[rows, None] + gap[:, None] * np.arange(1, PARTS) / PARTS
    return high, status, u


def _is_irregular(system, u):
    """Return whether amplitudes on motions from u (n, k) go up and down; else one may be slow."""
    amplitudes = np.empty((RETURNS, len(u)))
    for amplitude in amplitudes:
        amplitude[:] = small_amplitude(system, u)
        u = return_map(system, state(system, u), np.full(len(u), ORBIT_RTOL)).image
    changes = np.diff(amplitudes, axis=0) / amplitudes[:-1]
    visible = np.abs(changes[1:]) > VISIBLE
    return ((changes[1:] * changes[:-1] < 0.0) & visible).sum(axis=0) >= TURNS


def _disturbed(system, kind, size):
    """Return x, v, psi (n, len(y)) right after disturbances of these kinds and sizes (n,)."""
    sign = np.where(kind % 2 == 0, 1.0, -1.0)
    y = steady_sliding_at(system, np.where(kind < 2, np.exp(-sign * size), 1.0))
    y[:, 0] += np.where(kind < 2, 0.0, sign * size)
    at_once = (kind >= 2) & (system.eta == 0.0)  # without mass friction follows the stress
    law, psi, p = system.friction_law, tuple(y[:, 2:].T), system.coefficients

    def excess_stress(v):
        return law.at(v, psi, p).S - y[:, 0]

    y[:, 1] = np.where(at_once, root(excess_stress, y[:, 1], at_once), y[:, 1])
    return y


def _largest_steps(system, columns):
    """Return ln (2, n) of the largest step up and down from stable steady sliding to V_lp.

    Steps up come from V_c_upper if V_lp is above it, steps down from V_c if V_lp is below it.
    """
    names = (*system.friction_law.symbols, "sigma", "K", "M")
    lower, upper = V_c(system.friction_law, **{name: columns[name] for name in names})
    V_lp, farthest = columns["V_lp"], SIZES[-1]
    with np.errstate(divide="ignore"):  # V_c may be 0 or inf
        upwards = np.where(V_lp > upper, np.log(V_lp / upper), np.inf)
        downwards = np.where(V_lp < lower, np.log(lower / V_lp), np.inf)
    return np.minimum([upwards, downwards], farthest)


def _unknown_points(system):
    """Return unknown points (n, k) of the section."""
    return np.full((len(system.kappa), 1 + len(system.friction_law.states)), np.nan)
