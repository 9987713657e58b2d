"""Which attractor a slider reaches from a given start: a limit cycle or steady sliding.

If steady sliding and cycles coexist, the answer depends on the start, so the search follows the
orbit itself, return by return.

- If successive returns differ little, the orbit leaps: by at most half of the remaining distance
  that Newton's method estimates, and at most a third of its distance from steady sliding, so that
  it does not pass over a fixed point that would attract it.
- Newton's method goes ahead of an orbit that is near an attracting fixed point.  The fixed point
  counts only if the orbit goes there too: if the return map is so nearly linear between the two
  that it contracts all the way.  Otherwise the orbit is followed further from where Newton's method
  left it.
- An orbit that keeps alternating between two points is followed by every second return, and so on:
  cycles of 2, 4, ... returns are fixed points of these iterates of the map.
- Near steady sliding rounding dominates the return map, and harmonic balance replaces it.
"""

from typing import NamedTuple

import numpy as np

from ...engine.model import FINISHED, NO_CONVERGENCE, RUNNING, STEADY_SLIDING
from .shooting import iterated_map, multipliers, newton_step, return_map
from .small_cycles import hopf_curvature, small_cycle
from .system import distance, select, small_amplitude, steady_sliding_at, tightest

# Steps of the search, returns of an orbit, and returns of a cycle, at most.
MAX_SEARCH_STEPS, MAX_RETURNS, LONGEST_PERIOD = 400, 2000, 32
# A cycle of m returns that closes after m/2 of them, to this part of its distance from u = 0, is a
# cycle of m/2.
MAX_CLOSURE = 1e-4
# Amplitude of ln V below which a stable steady sliding is reached; and below which a cycle is
# small enough for harmonic balance.
STEADY, SMALL = 1e-2, 2e-2
# Below this amplitude no unstable cycle is looked for beside stable steady sliding.
SMALLEST = 1e-5
# V_lp divided by the speed of the steady sliding from which a search starts by default.
SLOWER = 10.0
# Loosest relative accuracy of a cycle: a looser one would not be cheaper.
LOOSEST_ANSWER = 1e-5
# Longest leap, and longest step of Newton's method that is trusted, relative to the distance from
# u = 0.  Without mass, leaps from unstable steady sliding are shorter: the motion may run away.
LARGEST_LEAP, LARGEST_LEAP_WITHOUT_MASS = 0.3, 0.03
# Share of the linear contraction by which the map may be nonlinear on the way to a fixed point.
NONLINEAR = 0.5
# Reversals in a row after which an orbit counts as alternating.
MAX_REVERSALS = 6
# A fixed point that the orbit does not reach may lie beside a cycle of twice the returns if its
# multiplier is below this.
FLIPS = -0.5
# The loosest tolerance of a return: beyond it derivatives of the map may be wrong.
LOOSEST = 1e-6
# The tolerance of a return divided by the change that it has to resolve.
FINER = 0.1
# A multiplier this near to 1 may be 1.
NEUTRAL = 1e-6
# The error of a return divided by its tolerance, as Newton's method may meet it: usually, and at
# the tightest tolerance.
NOISE, NOISE_AT_TIGHTEST = 3.0, 1e4


class CycleEstimates(NamedTuple):
    """A point on the section for each of n sliders, near its limit cycle."""

    status: np.ndarray  # engine.model: FINISHED is a cycle
    #: (n, k) the stress maximum of the cycle; without a cycle, the orbit's last one, or NaN if it
    #: did not come back to the section
    u: np.ndarray
    tol: np.ndarray  # (n,) tolerance of the return that led there
    period: np.ndarray  # (n,) [Dc/V_lp]; without a cycle, the time of the last returns
    error: np.ndarray  # (n,) estimated relative error if known, as of a small cycle; else 0
    n_returns: np.ndarray  # (n,) how many returns make the period

    def at(self, rows):
        """Return the sliders with these numbers, or where `rows` is True."""
        return select(self, rows)


def single_returns(u, tol, period, error=0.0, status=FINISHED):
    """Return `CycleEstimates` of cycles of one return; error and status may be one value."""
    n = len(u)
    values = np.full(n, status), u, tol, period, np.full(n, error), np.ones(n, np.int64)
    return CycleEstimates(*values)


def steady_start(system, slower=SLOWER):
    """Return x, v, psi (n, len(y)) of steady sliding at V_lp/slower, where a search starts."""
    return steady_sliding_at(system, np.full(len(system.kappa), 1.0 / slower))


def find_attractors(system, start, rtol, progress, loosest=LOOSEST):
    """Follow n > 0 sliders from the states start (n, len(y)) to their attractors.

    Returns `CycleEstimates`.  The status is FINISHED if a cycle attracts the orbit, STEADY_SLIDING
    near stable steady sliding, and NO_CONVERGENCE after MAX_RETURNS returns or MAX_SEARCH_STEPS
    steps.  An orbit that does not come back to the section has the status of that return.

    rtol : relative accuracy of the cycle; at most 1e-5 is used
    progress : callable or None, given the fraction of sliders whose search is over
    loosest : (n,) largest tolerance of a return
    """
    n = len(start)
    rtol, loosest = min(rtol, LOOSEST_ANSWER), np.broadcast_to(loosest, n)
    stable = system.stable
    steady_tol = np.where(stable, 1e-6, 0.0)
    first = return_map(system, start, loosest, steady_tol=steady_tol)
    status = np.where(first.has_returned, RUNNING, first.status)
    period = first.numbers["period"]
    estimates = single_returns(first.image.copy(), loosest.astype(float), period, status=status)
    search, followed = np.zeros(n, _search_type(start.shape[1] - 1)), np.ones(n, np.int64)
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
        on_orbit = returns.has_returned & ~searching["ahead"]
        r = np.where(on_orbit, small_amplitude(part, current.u), np.inf)
        estimates.status[active] = np.where(returns.has_returned, RUNNING, returns.status)
        estimates.period[active] = returns.numbers["period"]
        estimates.u[active], estimates.tol[active], converged, doubled = _advance_search(
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
    rows = np.flatnonzero((estimates.status == FINISHED) & (estimates.n_returns > 1))
    while len(rows):
        part, cycles = system.at(rows), estimates.at(rows)
        half = iterated_map(part, cycles.u, cycles.tol, cycles.n_returns // 2)
        closes = distance(part, half.image - cycles.u) <= MAX_CLOSURE * distance(part, cycles.u)
        rows = rows[closes]
        estimates.n_returns[rows] //= 2
        estimates.period[rows] *= 0.5
        rows = rows[estimates.n_returns[rows] > 1]


def _finish_at_rest(system, estimates, active, r):
    """Mark as steady sliding those active sliders whose amplitude r is small enough.

    Beside stable sliding, only unstable cycles are that small; an orbit inside them spirals in.
    """
    rows, r = active[r < STEADY], r[r < STEADY]
    if len(rows):
        part = system.at(rows)
        inside = (part.margin > hopf_curvature(part) * r**2) | (r < SMALLEST)
        estimates.status[rows[inside]] = STEADY_SLIDING


def _finish_on_small_cycles(system, estimates, rows):
    """Put those small cycles of these sliders that harmonic balance finds into the estimates."""
    if not (len(rows) and system.friction_law.one_length):
        return
    part = system.at(rows)
    cycles = small_cycle(part.law, part.kappa, part.beta, part.eta)
    is_small = cycles.valid & (cycles.r < 2.0 * SMALL)
    rows, cycles = rows[is_small], select(cycles, is_small)
    estimates.status[rows] = FINISHED
    estimates.u[rows] = np.stack([cycles.psi, cycles.G], axis=1)
    estimates.period[rows] = 2.0 * np.pi / cycles.omega
    estimates.error[rows] = cycles.error
    estimates.tol[rows] = tightest(system.at(rows), estimates.u[rows])


# One step of the search


def _search_type(k):
    """Return the dtype of a search whose points u are k numbers."""
    return np.dtype(
        [
            ("longest", float),  # longest first step that Newton's method is allowed
            ("ahead", bool),  # whether Newton's method is at work
            # where it left the orbit: u, the image, the larger multiplier, the first step's length
            *[("u", float, k), ("image", float, k), ("multiplier", complex), ("step", float)],
            # where the orbit goes on if Newton's method fails
            *[("next_u", float, k), ("next_tol", float)],
            # the orbit's last move, and how many times in a row it has reversed its direction
            *[("move", float, k), ("reversals", int)],
        ]
    )


class LocalMap(NamedTuple):
    """The map linearised at the points u of n sliders, and the accuracy that it has and needs."""

    target: np.ndarray  # (n, k) where Newton's method goes
    step: np.ndarray  # (n,) length of its step, relative to the distance from u = 0
    first: np.ndarray  # (n,) the larger multiplier
    others: np.ndarray  # (n, k - 1)
    attracts: np.ndarray  # (n,) whether the target may be a fixed point that attracts
    resolved: np.ndarray  # (n,) whether the target is as accurate as requested, or as possible
    tol_per_part: np.ndarray  # (n,) tolerance divided by the part of a return to be resolved
    finest: np.ndarray  # (n,) smallest useful tolerance


def _advance_search(system, returns, current, search, rtol, loosest, leap):
    """Advance the search, in place, by the `Returns` from the `CycleEstimates` current.

    Returns the next u (n, k), the next tolerance (n,), whether u is on the cycle that the orbit
    reaches, and whether to follow the orbit by twice as many returns from here on.

    leap : whether the orbit may leap
    """
    local = _local_map(system, returns, current, rtol)
    on_orbit = ~search["ahead"]
    limit = np.where(on_orbit, search["longest"], LARGEST_LEAP)
    trusted = local.attracts & (local.step <= limit)
    leapt = _leap(system, returns, current.u, local, leap & on_orbit)
    search["next_u"][on_orbit] = leapt[on_orbit]
    search["next_tol"][on_orbit] = _tolerance(local, 0.1, loosest)[on_orbit]
    departs = trusted & on_orbit
    point = {"u": current.u, "image": returns.image, "multiplier": local.first, "step": local.step}
    for name, value in point.items():
        search[name][departs] = value[departs]
    arrives = trusted & local.resolved
    excess = _nonlinearity(system, returns, search, local) / NONLINEAR
    converged = arrives & (excess <= 1.0)
    refuted = arrives & ~converged
    # If Newton's method fails, its next first step from the orbit is to be shorter.
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        nearer = search["step"] * np.where(arrives, np.clip(0.5 / excess, 1e-3, 0.5), 0.3)
    fails = (search["ahead"] & ~trusted) | refuted
    search["longest"] = np.where(fails, nearer, search["longest"])
    search["ahead"] = trusted & ~refuted
    doubled = _alternates(system, search, returns.image - current.u, local.first, refuted, on_orbit)
    doubled &= ~converged & (2 * current.n_returns <= LONGEST_PERIOD)
    search["longest"][doubled], search["reversals"][doubled] = LARGEST_LEAP, 0
    go = search["ahead"] | converged
    next_u = np.where(go[:, None], local.target, search["next_u"])
    next_tol = np.where(go, _tolerance(local, local.step, loosest), search["next_tol"])
    return next_u, next_tol, converged, doubled


def _local_map(system, returns, current, rtol):
    """Return the `LocalMap` at the `CycleEstimates` current, from which the returns begin."""
    u, newton = current.u, newton_step(returns, current.u)
    size, length = distance(system, u), distance(system, returns.image - u)
    found = multipliers(returns)
    first, others = found[:, 0], found[:, 1:]
    target, step = u + newton, distance(system, newton) / size
    # The engine's tolerance is absolute in ln V, so a small cycle needs a smaller one.
    scale = np.minimum(1.0, small_amplitude(system, u))
    attraction = np.fmin(1.0, np.abs(1.0 - first))
    floor = tightest(system, u)
    finest = np.maximum(rtol * scale * attraction, floor)
    noise = np.where(current.tol > floor, NOISE, NOISE_AT_TIGHTEST)
    with np.errstate(divide="ignore", over="ignore"):  # a multiplier of about 1 resolves nothing
        resolution = np.maximum(rtol, noise * current.tol / (scale * attraction))
    return LocalMap(
        target,
        step,
        first,
        others,
        attracts=(np.abs(first) < 1.0) & (target[:, -1] > 0.0),
        resolved=(current.tol <= 2.0 * finest) & (step <= resolution),
        tol_per_part=FINER * length / size * scale,
        finest=finest,
    )


def _tolerance(local, part, loosest):
    """Return the tolerance (n,) of a return that is to resolve this part of the last move."""
    with np.errstate(invalid="ignore"):
        tol = np.nan_to_num(local.tol_per_part * part, nan=LOOSEST)
    return np.clip(tol, local.finest, loosest)


def _leap(system, returns, u, local, can_leap):
    """Return the image of u or, if the orbit may leap, a point further along its slow direction.

    A leap must not pass a fixed point, nor amplify returns that alternate.
    """
    move, size = returns.image - u, distance(system, u)
    first, slow = local.first, move.astype(complex)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for other in local.others.T:
            matrix = returns.jacobian - other[:, None, None] * np.eye(u.shape[1])
            slow = (matrix @ slow[:, :, None])[:, :, 0] / (first - other)[:, None]
        slow = slow.real
        slow_size = distance(system, slow)
        max_step = 0.5 * slow_size / np.abs(1.0 - first)
        can_be_large = system.stable | (system.eta > 0.0)
        largest = np.where(can_be_large, LARGEST_LEAP, LARGEST_LEAP_WITHOUT_MASS)
        leap = np.minimum(largest * size, max_step) / slow_size - 1.0
        # Without inertia, orbits at K_c may be neutral, so that leaps would be a random walk; and
        # under laws of one length there is no cycle to leap to.
        can_leap = can_leap & (first.imag == 0.0) & (first.real > 0.0)
        has_cycle = system.stable | (not system.friction_law.one_length)
        can_leap &= (system.eta > 0.0) | (has_cycle & (np.abs(1.0 - first) > NEUTRAL))
        # If faster parts of the move are larger, they hide the slow one, and the map bends.
        can_leap &= distance(system, move - slow) <= slow_size
        leapt = returns.image + np.where(can_leap, leap, 0.0)[:, None] * slow
    leaps = can_leap & (leap > 0.0) & (leapt[:, -1] > 0.0)
    return np.where(leaps[:, None], leapt, returns.image)


def _nonlinearity(system, returns, search, local):
    """Return how far the map is from linear between the orbit and the fixed point.

    It is a share of 1 - |multiplier|: below 1 the map contracts all the way, and takes the orbit to
    the fixed point.  The estimate uses the multipliers at both ends, and the image of the point
    where Newton's method left the orbit.
    """
    begin, image = search["u"] - local.target, search["image"] - local.target
    departure, first = search["multiplier"], local.first
    change = np.hypot(departure.real - first.real, np.abs(departure.imag) - np.abs(first.imag))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        linear = (returns.jacobian @ begin[:, :, None])[:, :, 0]
        deviation = np.nan_to_num(distance(system, image - linear) / distance(system, begin))
        return np.maximum(deviation, change) / (1.0 - np.abs(first))


def _alternates(system, search, move, first, refuted, on_orbit):
    """Return whether an orbit is to be followed by twice as many returns.

    It is if it keeps reversing its direction; or if Newton's fixed point is refuted, but is near
    the period doubling at which a cycle of twice the returns appears.
    """
    last = search["move"]
    projection = (system.weights**2 * move * last).sum(axis=1)
    reversals = np.where(projection < 0.0, search["reversals"] + 1, 0)
    search["reversals"] = np.where(on_orbit, reversals, search["reversals"])
    search["move"] = np.where(on_orbit[:, None], move, last)
    flips = refuted & (first.imag == 0.0) & (first.real < FLIPS)
    return flips | (search["reversals"] >= MAX_REVERSALS)
