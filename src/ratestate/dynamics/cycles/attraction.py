"""From an orbit to the fixed point that it goes to.

The orbit is followed return by return.  Where successive returns differ little it leaps: by at most
half of what Newton's method says is left, and at most a third of the orbit's distance from steady
sliding, so that it does not pass over a fixed point that would have held it.

Newton's method goes ahead from where the orbit is near enough to a fixed point that attracts.  What
it finds counts only if the orbit goes there too: if the return map is so nearly linear between the
two that it contracts all the way.  Else the orbit is followed further, from where it was left.

An orbit that keeps alternating between two places is followed by every second return, and so on:
cycles of 2, 4, ... returns are fixed points of these iterates of the map.
"""

from typing import NamedTuple

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


class View(NamedTuple):
    """What the map says at the points u of n sliders."""

    target: np.ndarray  # (n, 2) where Newton's method goes
    left: np.ndarray  # (n,) how far that is, relative to the distance from u = 0
    first: np.ndarray  # (n,) the larger multiplier
    second: np.ndarray  # (n,)
    attracts: np.ndarray  # (n,) whether the target may be a fixed point that attracts
    arrives: np.ndarray  # (n,) whether the target is known as well as is asked, or as can be
    pace: np.ndarray  # (n,) tolerance over the part of a return that is to be resolved
    finest: np.ndarray  # (n,) tolerance that is of use


def advance(system, turns, now, here, rtol, loosest, leap):
    """The next u and tolerance, whether a cycle is found there, and whether to double the returns.

    now, here : `Settled` and SEARCH of these sliders; the latter is brought up to date
    loosest : (n,) tolerance of a turn, at most
    """
    view = _view(system, turns, now, rtol)
    on_orbit = ~here["ahead"]
    trusted = view.attracts & (view.left <= np.where(on_orbit, here["reach"], REACH))
    here["next_u"][on_orbit] = _leap(system, turns, now.u, view, leap & on_orbit)[on_orbit]
    here["next_tol"][on_orbit] = _tolerance(view, 0.1, loosest)[on_orbit]
    departs = trusted & on_orbit
    for name, value in (
        ("u", now.u),
        ("image", turns.image),
        ("multiplier", view.first),
        ("left", view.left),
    ):
        here[name][departs] = value[departs]
    arrives = trusted & view.arrives
    excess = _nonlinearity(system, turns, here, view) / NONLINEAR
    done = arrives & (excess <= 1.0)
    fails = (here["ahead"] & ~trusted) | (arrives & ~done)
    with np.errstate(invalid="ignore", divide="ignore"):
        nearer = here["left"] * np.where(arrives, np.clip(0.5 / excess, 1e-3, 0.5), 0.3)
    here["reach"] = np.where(fails, nearer, here["reach"])
    here["ahead"] = trusted & ~fails
    doubled = _alternates(system, here, turns.image - now.u, view.first, arrives & fails, on_orbit)
    doubled &= ~done & (2 * now.returns <= MOST_RETURNS)
    here["reach"][doubled], here["reversals"][doubled] = REACH, 0
    go = here["ahead"] | done
    next_u = np.where(go[:, None], view.target, here["next_u"])
    next_tol = np.where(go, _tolerance(view, view.left, loosest), here["next_tol"])
    return next_u, next_tol, done, doubled


def _view(system, turns, now, rtol):
    """`View` of sliders at `Settled` now, of which a turn is known."""
    u, newton = now.u, newton_step(turns, now.u)
    size, length = distance(system, u), distance(system, turns.image - u)
    first, second = multipliers(turns).T
    target, left = u + newton, distance(system, newton) / size
    # The engine's tolerance is absolute in ln V, and that of a small cycle must be smaller.
    scale = np.minimum(1.0, small_amplitude(system, u))
    attraction = np.nan_to_num(np.minimum(1.0, np.abs(1.0 - first)), nan=1.0)
    floor = tightest(system, u)
    finest = np.maximum(rtol * scale * attraction, floor)
    noise = np.where(now.tol > floor, NOISE, ROUNDING)
    with np.errstate(divide="ignore"):  # a multiplier of exactly 1 resolves nothing
        resolved = np.maximum(rtol, noise * now.tol / (scale * attraction))
    return View(
        target,
        left,
        first,
        second,
        (np.abs(first) < 1.0) & (target[:, 1] > 0.0),
        (now.tol <= 2.0 * finest) & (left <= resolved),
        FINER * length / size * scale,
        finest,
    )


def _tolerance(view, part, loosest):
    """(n,) tolerance of the next return, of which this part is to be resolved."""
    with np.errstate(invalid="ignore"):
        wanted = np.nan_to_num(view.pace * part, nan=LOOSE)
    return np.clip(wanted, view.finest, loosest)


def _leap(system, turns, u, view, may):
    """(n, 2) the image of u or, where the orbit may leap, a point further along its slow direction.

    A leap must not pass a fixed point, nor amplify returns that alternate.
    """
    move, size = turns.image - u, distance(system, u)
    first, second = view.first, view.second
    with np.errstate(divide="ignore", invalid="ignore"):
        matrix = turns.jacobian - second.real[:, None, None] * np.eye(2)
        slow = (matrix @ move[:, :, None])[:, :, 0] / (first - second).real[:, None]
        along = distance(system, slow)
        until = 0.5 * along / np.abs(1.0 - first)
        more = np.minimum(REACH * size, until) / along - 1.0
        # Without inertia orbits are all but neutral at K_c_qs: a leap there would be a random walk.
        may = may & (first.imag == 0.0) & (first.real > 0.0) & (system.eta > 0.0)
        leapt = turns.image + np.where(may, more, 0.0)[:, None] * slow
    far = may & (more > 0.0) & (leapt[:, 1] > 0.0)
    return np.where(far[:, None], leapt, turns.image)


def _nonlinearity(system, turns, here, view):
    """How far the map is from linear between where the orbit was left and a fixed point.

    As a share of 1 - |multiplier|: below 1 the map contracts in all that distance, and takes the
    orbit to the fixed point.  Told by the multiplier at its two ends, and by the image of one.
    """
    begin, image = here["u"] - view.target, here["image"] - view.target
    linear = (turns.jacobian @ begin[:, :, None])[:, :, 0]
    there, first = here["multiplier"], view.first
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
