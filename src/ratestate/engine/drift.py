"""What a step of Rodas5P takes from equations that change in time by themselves.

They do where the load point accelerates, and where normal stress varies.
"""

from typing import NamedTuple

from ..friction.tuples import minus_dot, plus, times

#: weight of what is a tuple of one number, or of none where normal stress is constant
UNITY = (1.0,)


class Drift(NamedTuple):
    """h d/dT of the equations at the start of a step, where x, v and psi are constant."""

    x: float  # of dx/dT
    v: tuple  # of m dv/dT
    psi: tuple  # of d psi/dT; this and v are () unless normal stress varies


def drift_of(y, w, h, ramp, system, start):
    """The `Drift` of a step from y."""
    law, kappa, _, p = system
    psi = times(h, law.rate_drift(y[1], w, y[2:], p))
    strength = times(-h, law.strength_drift(y[1], w, y[2:], p))
    return Drift(h * kappa * ramp, less_share(strength, start, psi), psi)


def less_share(strength, start, psi):
    """Of m dv/dT, where it has any: the strength's, and what the states take."""
    if len(strength) == 0:
        return ()
    return (minus_dot(strength[0], times(start.m, start.shares), psi),)


def with_drift(rest, drift, d):
    """sum_j (C_ij/h) k_j + h d_i df/dT at a stage of this d_i; v's apart."""
    psi = with_states(rest[2:], d, drift.psi)
    return (rest[0] + d * drift.x, rest[1], *psi), times(d, drift.v)


def with_states(rest, d, drift):
    """rest + d drift, where there is a drift."""
    if len(drift) == 0:
        return rest
    return plus(rest, times(d, drift))
