"""Which limit cycle a slider settles into, and that cycle to full accuracy.

Where steady sliding and cycles coexist, the answer depends on the start.  So the orbit itself is
followed from the start on, turn by turn; but where successive turns differ little it leaps, by at
most half of what Newton's method says is left, and by no more than a third of itself, so that it
does not pass over a fixed point that would have held it.  Near a stable one, Newton's method takes
over.  Near steady sliding, where the return map drowns in rounding, harmonic balance does.
"""

from typing import NamedTuple

import numpy as np

from .engine.model import FINISHED, NO_CONVERGENCE, RUNNING, STEADY_SLIDING
from .shooting import distance, multipliers, newton_step, small_amplitude, state, turn
from .soft import curvature, soft_cycle

# Turns after which a slider that has not settled counts as never settling.
MOST_ROUNDS = 400
# A leap, and a step of Newton's method that is trusted, relative to the distance from u = 0.
REACH = 0.3
# Amplitudes of ln V below which a stable steady sliding is reached; below which cycles are soft.
STEADY, SOFT = 1e-2, 2e-2
# Tolerance of a step in x, v and psi: the loosest (beyond which derivatives of the map may be
# wrong), and what rounding of numbers of order 1 allows.
LOOSE, TIGHTEST = 1e-6, 2e-14
# Looser answers are not cheaper.
LOOSEST_ANSWER = 1e-5
# How much finer than what it moves a turn must be.
FINER = 0.1
# Errors of a turn, in its tolerance, with which Newton's method must live; at the tightest.
NOISE, ROUNDING = 3.0, 1e4


class Settled(NamedTuple):
    """Where n sliders end up."""

    status: np.ndarray  # engine.model: FINISHED is a cycle
    u: np.ndarray  # (n, 2) its stress maximum; where there is none, the last one
    tol: np.ndarray  # (n,) tolerance of its turn
    period: np.ndarray  # (n,)
    error: np.ndarray  # (n,) of a soft cycle, estimated relative error; 0 elsewhere

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return Settled(*(values[which] for values in self))


def steady_start(system):
    """(n, 3) x, v, psi of steady sliding at V_lp/10."""
    v = np.full(len(system.beta), -np.log(10.0))
    return np.stack([(1.0 - system.beta) * v, v, -v], axis=1)


def settle(system, start, rtol, alone, progress):
    """Follow n sliders from the states start (n, 3) until they settle; `Settled`.

    rtol : relative accuracy of the cycle
    alone : whether this is the one case of a call
    progress : callable or None, given the fraction of sliders that have settled
    """
    n = len(start)
    rtol = min(rtol, LOOSEST_ANSWER)
    stable = system.margin >= 0.0
    steady_tol = np.where(stable, 1e-6, 0.0)
    first = turn(system, start, LOOSE, alone=alone, steady_tol=steady_tol)
    found = Settled(
        np.where(first.came_back, RUNNING, first.status),
        first.image.copy(),
        np.full(n, LOOSE),
        first.numbers["period"],
        np.zeros(n),
    )
    for number in range(MOST_ROUNDS):
        active = np.flatnonzero(found.status == RUNNING)
        if progress:
            progress(1.0 - len(active) / n)
        if not len(active):
            break
        part, u, tol = system.at(active), found.u[active], found.tol[active]
        turns = turn(part, state(part, u), tol, alone=alone, steady_tol=steady_tol[active])
        found.status[active] = np.where(turns.came_back, RUNNING, turns.status)
        found.period[active] = turns.numbers["period"]
        found.u[active], found.tol[active], done = _advance(
            part, turns, u, tol, rtol, leap=number > 0
        )
        found.status[active[done]] = FINISHED
        small = np.where(turns.came_back, small_amplitude(part, u), np.inf)
        _come_to_rest(system, found, active, np.where(stable[active], small, np.inf))
        _soften(system, found, active[~stable[active] & (small < SOFT)])
    found.status[found.status == RUNNING] = NO_CONVERGENCE
    return found


def _advance(system, turns, u, tol, rtol, leap):
    """The next u and tolerance, and whether Newton's method has converged there."""
    move = turns.image - u
    newton = newton_step(turns, u)
    size, length = distance(system, u), distance(system, move)
    left = distance(system, newton) / size
    first, second = multipliers(turns).T
    attracts = np.abs(first) < 1.0
    rising = (u + newton)[:, 1] > 0.0
    trusted = attracts & rising & (left <= REACH)
    # A leap prolongs what the turn moved along its slow direction.  It must not pass a fixed
    # point, nor amplify turns that alternate.
    with np.errstate(divide="ignore", invalid="ignore"):
        matrix = turns.jacobian - second.real[:, None, None] * np.eye(2)
        slow = (matrix @ move[:, :, None])[:, :, 0] / (first - second).real[:, None]
        along = distance(system, slow)
        until = np.where(attracts, 0.5 * along / np.abs(1.0 - first), np.inf)
        more = np.minimum(REACH * size, until) / along - 1.0
        # Without inertia orbits are all but neutral at K_c_qs: a leap there would be a random walk.
        may = leap & (first.imag == 0.0) & (first.real > 0.0) & (system.eta > 0.0)
        more = np.where(may, more, 0.0)
        leapt = turns.image + more[:, None] * slow
    leapt = np.where(((more > 0.0) & (leapt[:, 1] > 0.0))[:, None], leapt, turns.image)
    attraction = np.nan_to_num(np.minimum(1.0, np.abs(1.0 - first)), nan=1.0)
    # The engine's tolerance is absolute in ln V, and that of a small cycle must be smaller.
    scale = np.minimum(1.0, small_amplitude(system, u))
    floor = tightest(system, u)
    finest = np.maximum(rtol * scale * attraction, floor)
    with np.errstate(invalid="ignore"):
        ahead = length / size * np.where(trusted, left, 0.1)
    next_tol = np.clip(np.nan_to_num(FINER * ahead * scale, nan=LOOSE), finest, LOOSE)
    noise = np.where(tol > floor, NOISE, ROUNDING)
    with np.errstate(divide="ignore"):  # a multiplier of exactly 1 resolves nothing
        resolved = np.maximum(rtol, noise * tol / (scale * attraction))
    done = trusted & (tol <= 2.0 * finest) & (left <= resolved)
    return np.where(trusted[:, None], u + newton, leapt), next_tol, done


def tightest(system, u):
    """(n,) the smallest tolerance that rounding of x leaves a meaning."""
    return TIGHTEST * np.maximum(1.0, distance(system, u))


def _come_to_rest(system, found, active, r):
    """Let sliders with these numbers end in steady sliding where their amplitudes r say so.

    Only unstable cycles are that small beside stable sliding; inside them it is reached.
    """
    which, r = active[r < STEADY], r[r < STEADY]
    if len(which):
        part = system.at(which)
        inside = part.margin > curvature(part.law, part.beta, part.eta) * r**2
        found.status[which[inside]] = STEADY_SLIDING


def _soften(system, found, which):
    """Put the soft cycles of these sliders into `found`, where they have one."""
    if not len(which):
        return
    part = system.at(which)
    soft = soft_cycle(part.law, part.kappa, part.beta, part.eta)
    near = soft.found & (soft.r < 2.0 * SOFT)
    which, soft = which[near], type(soft)(*(values[near] for values in soft))
    found.status[which] = FINISHED
    found.u[which] = np.stack([soft.psi, soft.G], axis=1)
    found.period[which] = 2.0 * np.pi / soft.omega
    found.error[which] = soft.error
    found.tol[which] = tightest(system.at(which), found.u[which])
