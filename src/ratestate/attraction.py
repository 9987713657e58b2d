"""From an orbit to the fixed point that it goes to.

The orbit is followed return by return; but where successive returns differ little it leaps, by at
most half of what Newton's method says is left, and by no more than a third of itself, so that it
does not pass over a fixed point that would have held it.

Newton's method goes ahead from where the orbit is near enough to a fixed point that attracts.  What
it finds counts only if the orbit goes there too: if the return map is so nearly linear between the
two that it contracts all the way.  Else the orbit is followed further, from where it was left.

An orbit that keeps alternating between two places is followed by every second return, and so on:
cycles of 2, 4, ... returns are fixed points of these iterates of the map.
"""

import numpy as np

from .shooting import distance, multipliers, newton_step, small_amplitude, tightest

# Of a cycle.
MOST_RETURNS = 32
# A leap, and a step of Newton's method that is trusted, relative to the distance from u = 0.
REACH = 0.3
# Share of the linear contraction by which the map may be nonlinear on the way to a fixed point.
NONLINEAR = 0.5
# Reversals in a row of an orbit that alternates.
ALTERNATES = 6
# A multiplier below which a fixed point that is not reached may lie beside a cycle of twice the
# returns.
FLIPS = -0.5
# The loosest tolerance of a turn: beyond it derivatives of the map may be wrong.
LOOSE = 1e-6
# How much finer than what it moves a turn must be.
FINER = 0.1
# Errors of a turn, in its tolerance, with which Newton's method must live; at the tightest.
NOISE, ROUNDING = 3.0, 1e4

#: how the search stands for a slider: the orbit, and Newton's method ahead of it
SEARCH = np.dtype(
    [
        ("reach", float),  # longest first step that Newton's method is allowed
        ("ahead", bool),  # whether it is at work
        # where it left the orbit: u, the image, the multiplier and the step there
        ("u", float, 2),
        ("image", float, 2),
        ("multiplier", complex),
        ("left", float),
        # where the orbit goes on if it fails
        ("next_u", float, 2),
        ("next_tol", float),
        # of the orbit: its last move, and how many times in a row it turned back
        ("move", float, 2),
        ("reversals", int),
    ]
)


def advance(system, turns, now, here, rtol, leap):
    """The next u and tolerance, whether a cycle is found there, and whether to double the returns.

    now, here : `Settled` and SEARCH of these sliders; the latter is brought up to date
    """
    u, tol = now.u, now.tol
    move, newton = turns.image - u, newton_step(turns, u)
    size, length = distance(system, u), distance(system, move)
    left = distance(system, newton) / size
    first, second = multipliers(turns).T
    attracts, target = np.abs(first) < 1.0, u + newton
    ahead = here["ahead"]
    reach = np.where(ahead, REACH, here["reach"])
    trusted = attracts & (target[:, 1] > 0.0) & (left <= reach)
    onward = _leap(system, turns, u, first, second, leap & ~ahead)
    # The engine's tolerance is absolute in ln V, and that of a small cycle must be smaller.
    scale = np.minimum(1.0, small_amplitude(system, u))
    attraction = np.nan_to_num(np.minimum(1.0, np.abs(1.0 - first)), nan=1.0)
    floor = tightest(system, u)
    finest = np.maximum(rtol * scale * attraction, floor)

    def tolerance(part):
        with np.errstate(invalid="ignore"):
            ahead_tol = np.nan_to_num(FINER * length / size * part * scale, nan=LOOSE)
        return np.clip(ahead_tol, finest, LOOSE)

    departs = trusted & ~ahead
    for name, value in (("u", u), ("image", turns.image), ("multiplier", first), ("left", left)):
        here[name][departs] = value[departs]
    here["next_u"][~ahead], here["next_tol"][~ahead] = onward[~ahead], tolerance(0.1)[~ahead]
    noise = np.where(tol > floor, NOISE, ROUNDING)
    with np.errstate(divide="ignore"):  # a multiplier of exactly 1 resolves nothing
        resolved = np.maximum(rtol, noise * tol / (scale * attraction))
    arrives = trusted & (tol <= 2.0 * finest) & (left <= resolved)
    excess = _nonlinearity(system, turns, here, target, first) / NONLINEAR
    done = arrives & (excess <= 1.0)
    fails = (ahead & ~trusted) | (arrives & ~done)
    with np.errstate(invalid="ignore", divide="ignore"):
        nearer = here["left"] * np.where(arrives, np.clip(0.5 / excess, 1e-3, 0.5), 0.3)
    here["reach"] = np.where(fails, nearer, here["reach"])
    here["ahead"] = trusted & ~fails
    doubled = _alternates(system, here, move, first, arrives & fails, ~ahead)
    doubled &= 2 * now.returns <= MOST_RETURNS
    here["reach"][doubled], here["reversals"][doubled] = REACH, 0
    go = here["ahead"] | done
    next_u = np.where(go[:, None], target, here["next_u"])
    return next_u, np.where(go, tolerance(left), here["next_tol"]), done, doubled


def _leap(system, turns, u, first, second, may):
    """(n, 2) the image of u or, where the orbit may leap, a point further along its slow direction.

    A leap must not pass a fixed point, nor amplify returns that alternate.
    """
    move = turns.image - u
    size, attracts = distance(system, u), np.abs(first) < 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        matrix = turns.jacobian - second.real[:, None, None] * np.eye(2)
        slow = (matrix @ move[:, :, None])[:, :, 0] / (first - second).real[:, None]
        along = distance(system, slow)
        until = np.where(attracts, 0.5 * along / np.abs(1.0 - first), np.inf)
        more = np.minimum(REACH * size, until) / along - 1.0
        # Without inertia orbits are all but neutral at K_c_qs: a leap there would be a random walk.
        may = may & (first.imag == 0.0) & (first.real > 0.0) & (system.eta > 0.0)
        leapt = turns.image + np.where(may, more, 0.0)[:, None] * slow
    far = may & (more > 0.0) & (leapt[:, 1] > 0.0)
    return np.where(far[:, None], leapt, turns.image)


def _nonlinearity(system, turns, here, target, first):
    """How far the map is from linear between where the orbit was left and a fixed point.

    As a share of 1 - |multiplier|: below 1 the map contracts in all that distance, and takes the
    orbit to the fixed point.  Told by the multiplier at its two ends, and by the image of one.
    """
    begin, image = here["u"] - target, here["image"] - target
    linear = (turns.jacobian @ begin[:, :, None])[:, :, 0]
    there = here["multiplier"]
    bend = np.hypot(there.real - first.real, np.abs(there.imag) - np.abs(first.imag))
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.nan_to_num(distance(system, image - linear) / distance(system, begin))
        return np.maximum(off, bend) / (1.0 - np.abs(first))


def _alternates(system, here, move, first, refuted, on_orbit):
    """Whether an orbit is to be followed by twice as many returns.

    Where it keeps turning back, or the fixed point found is not what it goes to, but about to give
    birth to a cycle of twice the returns.
    """
    before = here["move"]
    along = system.beta**2 * move[:, 0] * before[:, 0] + system.eta**2 * move[:, 1] * before[:, 1]
    reversals = np.where(along < 0.0, here["reversals"] + 1, 0)
    here["reversals"] = np.where(on_orbit, reversals, here["reversals"])
    here["move"] = np.where(on_orbit[:, None], move, before)
    flips = refuted & (first.imag == 0.0) & (first.real < FLIPS)
    return flips | (here["reversals"] >= ALTERNATES)
