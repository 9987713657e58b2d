"""Which limit cycle a slider settles into, and that cycle to full accuracy.

Where steady sliding and cycles coexist, the answer depends on the start.  So the orbit itself is
followed from the start on, with what attraction.py knows of where it goes.  Near steady sliding,
where the return map drowns in rounding, harmonic balance takes over.
"""

from typing import NamedTuple

import numpy as np

from ...engine.model import FINISHED, NO_CONVERGENCE, RUNNING, STEADY_SLIDING
from .attraction import LOOSE, REACH, SEARCH, advance
from .iterates import iterate
from .shooting import distance, small_amplitude, tightest, turn
from .small_cycles import curvature, soft_cycle

# Steps of the search, and returns of an orbit, after which a slider counts as never settling.
MOST_ROUNDS, MOST_FOLLOWED = 400, 2000
# Distance, relative to that from u = 0, to which a cycle closes after half its returns.
CLOSES = 1e-4
# Amplitudes of ln V below which a stable steady sliding is reached; below which cycles are soft.
STEADY, SOFT = 1e-2, 2e-2
# Looser answers are not cheaper.
LOOSEST_ANSWER = 1e-5


class Settled(NamedTuple):
    """Where n sliders end up."""

    status: np.ndarray  # engine.model: FINISHED is a cycle
    u: np.ndarray  # (n, 2) its stress maximum; where there is none, the last one
    tol: np.ndarray  # (n,) tolerance of its turn
    period: np.ndarray  # (n,)
    error: np.ndarray  # (n,) of a soft cycle, estimated relative error; 0 elsewhere
    returns: np.ndarray  # (n,) how many make the period

    def at(self, which):
        """The sliders with these numbers, or where this is true."""
        return Settled(*(values[which] for values in self))


def steady_start(system):
    """(n, 3) x, v, psi of steady sliding at V_lp/10."""
    v = np.full(len(system.beta), -np.log(10.0))
    return np.stack([(1.0 - system.beta) * v, v, -v], axis=1)


def settle(system, start, rtol, alone, progress, loosest=LOOSE):
    """Follow n sliders from the states start (n, 3) until they settle; `Settled`.

    rtol : relative accuracy of the cycle
    alone : whether this is the one case of a call
    progress : callable or None, given the fraction of sliders that have settled
    loosest : (n,) tolerance of a turn, at most; as close as this the orbit itself is followed
    """
    n = len(start)
    loosest = np.broadcast_to(loosest, n)
    rtol = min(rtol, LOOSEST_ANSWER)
    stable = system.margin >= 0.0
    steady_tol = np.where(stable, 1e-6, 0.0)
    first = turn(system, start, loosest, alone=alone, steady_tol=steady_tol)
    found = Settled(
        np.where(first.came_back, RUNNING, first.status),
        first.image.copy(),
        loosest.astype(float),
        first.numbers["period"],
        np.zeros(n),
        np.ones(n, np.int64),
    )
    search, followed = np.zeros(n, SEARCH), np.ones(n, np.int64)
    soft_untried = ~stable
    search["reach"] = REACH
    for number in range(MOST_ROUNDS):
        active = np.flatnonzero((found.status == RUNNING) & (followed < MOST_FOLLOWED))
        if progress:
            progress(1.0 - len(active) / n)
        if not len(active):
            break
        part, now, here = system.at(active), found.at(active), search[active]
        turns = iterate(
            part, now.u, now.tol, now.returns, alone=alone, steady_tol=steady_tol[active]
        )
        followed[active] += now.returns
        found.status[active] = np.where(turns.came_back, RUNNING, turns.status)
        found.period[active] = turns.numbers["period"]
        on_orbit = ~here["ahead"]
        found.u[active], found.tol[active], done, doubled = advance(
            part, turns, now, here, rtol, loosest[active], leap=number > 0
        )
        found.returns[active] = np.where(doubled, 2 * now.returns, now.returns)
        search[active] = here
        found.status[active[done]] = FINISHED
        small = np.where(turns.came_back & on_orbit, small_amplitude(part, now.u), np.inf)
        _come_to_rest(system, found, active, np.where(stable[active], small, np.inf))
        nearly = active[soft_untried[active] & (small < SOFT)]
        _soften(system, found, nearly)
        soft_untried[nearly] = False
    found.status[found.status == RUNNING] = NO_CONVERGENCE
    _halve(system, found, alone)
    return found


def _halve(system, found, alone):
    """Put down what closes after half its returns already as a cycle of these."""
    which = np.flatnonzero((found.status == FINISHED) & (found.returns > 1))
    while len(which):
        part, now = system.at(which), found.at(which)
        half = iterate(part, now.u, now.tol, now.returns // 2, alone=alone)
        closes = distance(part, half.image - now.u) <= CLOSES * distance(part, now.u)
        which = which[closes]
        found.returns[which] //= 2
        found.period[which] *= 0.5
        which = which[found.returns[which] > 1]


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
