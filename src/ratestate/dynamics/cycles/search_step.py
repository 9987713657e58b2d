"""One step of the attractor search: from an orbit to the fixed point that it converges to.

The orbit is followed return by return.  Where successive returns differ little it leaps: by at most
half of the remaining distance that Newton's method estimates, and at most a third of the orbit's
distance from steady sliding, so that it does not pass over a fixed point that would attract it.

Newton's method goes ahead of the orbit where the orbit is near enough to an attracting fixed point.
The fixed point that it finds counts only if the orbit goes there too: if the return map is so
nearly linear between the two that it contracts all the way.  Otherwise the orbit is followed
further, from where Newton's method left it.

An orbit that keeps alternating between two points is followed by every second return, and so on:
cycles of 2, 4, ... returns are fixed points of these iterates of the map.
"""

from typing import NamedTuple

import numpy as np

from .shooting import multipliers, newton_step
from .system import distance, small_amplitude, tightest

# Returns of a cycle.
LONGEST_PERIOD = 32
# Longest leap, and longest step of Newton's method that is trusted, relative to the distance from
# u = 0.
LARGEST_LEAP = 0.3
# Longest leap without mass where steady sliding is unstable: a motion that is disturbed may run
# away.
LARGEST_LEAP_WITHOUT_MASS = 0.03
# Share of the linear contraction by which the map may be nonlinear on the way to a fixed point.
NONLINEAR = 0.5
# Reversals in a row after which an orbit counts as alternating.
ALTERNATES = 6
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


def search_type(k):
    """The dtype of the state of the search for a slider whose section's points are k numbers."""
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
    tol_per_part: np.ndarray  # (n,) tolerance over the part of a return that is to be resolved
    finest: np.ndarray  # (n,) smallest useful tolerance


def advance_search(system, returns, current, search, rtol, loosest, leap):
    """Advance the search by the `Returns` of n sliders from `CycleEstimates` current.

    search : of `search_type`, of these sliders, updated in place
    loosest : (n,) largest tolerance of a return
    leap : whether the orbit may leap

    Gives the next u (n, k) and tolerance (n,), whether (n,) that is on the cycle that the orbit
    goes to, and whether the orbit is to be followed by twice as many returns from here on.
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
    converged, refuted = _arrivals(system, returns, search, local, trusted)
    search["ahead"] = trusted & ~refuted
    doubled = _alternates(system, search, returns.image - current.u, local.first, refuted, on_orbit)
    doubled &= ~converged & (2 * current.n_returns <= LONGEST_PERIOD)
    search["longest"][doubled], search["reversals"][doubled] = LARGEST_LEAP, 0
    go = search["ahead"] | converged
    next_u = np.where(go[:, None], local.target, search["next_u"])
    next_tol = np.where(go, _tolerance(local, local.step, loosest), search["next_tol"])
    return next_u, next_tol, converged, doubled


def _arrivals(system, returns, search, local, trusted):
    """Whether Newton's method has found where the orbit goes, or a fixed point that is refuted.

    Where it fails its next first step from the orbit is to be shorter.
    """
    arrives = trusted & local.resolved
    excess = _nonlinearity(system, returns, search, local) / NONLINEAR
    converged = arrives & (excess <= 1.0)
    refuted = arrives & ~converged
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        nearer = search["step"] * np.where(arrives, np.clip(0.5 / excess, 1e-3, 0.5), 0.3)
    fails = (search["ahead"] & ~trusted) | refuted
    search["longest"] = np.where(fails, nearer, search["longest"])
    return converged, refuted


def _local_map(system, returns, current, rtol):
    """`LocalMap` of sliders at `CycleEstimates` current, of which the returns are given."""
    u, newton = current.u, newton_step(returns, current.u)
    size, length = distance(system, u), distance(system, returns.image - u)
    found = multipliers(returns)
    first, others = found[:, 0], found[:, 1:]
    target, step = u + newton, distance(system, newton) / size
    # The engine's tolerance is absolute in ln V, and that of a small cycle must be smaller.
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
    """(n,) tolerance of the next return, which is to resolve this part of the last move."""
    with np.errstate(invalid="ignore"):
        tol = np.nan_to_num(local.tol_per_part * part, nan=LOOSEST)
    return np.clip(tol, local.finest, loosest)


def _leap(system, returns, u, local, may):
    """(n, k) the image of u or, where the orbit may leap, a point further along its slow direction.

    A leap must not pass a fixed point, nor amplify returns that alternate.
    """
    move, size = returns.image - u, distance(system, u)
    first, slow = local.first, move.astype(complex)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for other in local.others.T:
            matrix = returns.jacobian - other[:, None, None] * np.eye(u.shape[1])
            slow = (matrix @ slow[:, :, None])[:, :, 0] / (first - other)[:, None]
        slow = slow.real
        along = distance(system, slow)
        until = 0.5 * along / np.abs(1.0 - first)
        stable = system.stable
        bold = stable | (system.eta > 0.0)
        largest = np.where(bold, LARGEST_LEAP, LARGEST_LEAP_WITHOUT_MASS)
        more = np.minimum(largest * size, until) / along - 1.0
        # Without inertia orbits may be neutral at K_c, where a leap would be a random walk, and by
        # laws of one length there is no cycle to leap to.
        may = may & (first.imag == 0.0) & (first.real > 0.0)
        leads = stable | (not system.friction_law.one_length)
        may &= (system.eta > 0.0) | (leads & (np.abs(1.0 - first) > NEUTRAL))
        # Where faster parts of the move are larger, they hide the slow one, and the map bends.
        may &= distance(system, move - slow) <= along
        leapt = returns.image + np.where(may, more, 0.0)[:, None] * slow
    far = may & (more > 0.0) & (leapt[:, -1] > 0.0)
    return np.where(far[:, None], leapt, returns.image)


def _nonlinearity(system, returns, search, local):
    """How far the map is from linear between where the orbit was left and a fixed point.

    As a share of 1 - |multiplier|: below 1 the map contracts over all that distance, and takes the
    orbit to the fixed point.  Estimated from the multipliers at both ends, and from the image of
    the point where the orbit was left.
    """
    begin, image = search["u"] - local.target, search["image"] - local.target
    departure, first = search["multiplier"], local.first
    change = np.hypot(departure.real - first.real, np.abs(departure.imag) - np.abs(first.imag))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        linear = (returns.jacobian @ begin[:, :, None])[:, :, 0]
        off = np.nan_to_num(distance(system, image - linear) / distance(system, begin))
        return np.maximum(off, change) / (1.0 - np.abs(first))


def _alternates(system, search, move, first, refuted, on_orbit):
    """Whether an orbit is to be followed by twice as many returns.

    That is where it keeps reversing its direction; or where Newton's fixed point is refuted, but
    is near the period doubling at which a cycle of twice the returns appears.
    """
    last = search["move"]
    along = (system.weights**2 * move * last).sum(axis=1)
    reversals = np.where(along < 0.0, search["reversals"] + 1, 0)
    search["reversals"] = np.where(on_orbit, reversals, search["reversals"])
    search["move"] = np.where(on_orbit[:, None], move, last)
    flips = refuted & (first.imag == 0.0) & (first.real < FLIPS)
    return flips | (search["reversals"] >= ALTERNATES)
