"""Steps of normal stress in a record."""

from typing import NamedTuple

import numpy as np

from .segments import segments_from_velocity

#: standard deviation, or change between levels, over the mean, from which a normal stress varies
VARIABLE = 0.01
#: rows on either side of a step of normal stress, between which most of the change happens
BESIDE, SUDDEN = 5, 0.6


class StressStep(NamedTuple):
    """A step of normal stress."""

    t: float  # [s]
    before: float  # mean levels [Pa]
    after: float


def varies(sigma):
    """Whether a normal stress (n,) is positive everywhere, finite, and varies."""
    return bool(_is_stress(sigma) and sigma.std() > VARIABLE * sigma.mean())


def stress_steps(time, sigma):
    """`StressStep`s (list) of a record of normal stress; where it changes slowly there is none.

    time, sigma : (n,) arrays [s], [Pa]
    """
    if not _is_stress(sigma) or np.ptp(sigma) <= VARIABLE * sigma.mean():
        return []
    levels = segments_from_velocity(time, sigma)
    steps = zip(levels.t[1:].tolist(), levels.V[:-1], levels.V[1:], strict=True)
    return [
        StressStep(t, float(before), float(after))
        for t, before, after in steps
        if abs(after - before) > VARIABLE * before and _is_sudden(time, sigma, t, after - before)
    ]


def _is_stress(sigma):
    return np.isfinite(sigma).all() and (sigma > 0.0).all()


def _is_sudden(time, sigma, t, change):
    """Whether a change of normal stress between two levels happens within some rows."""
    at = int(np.searchsorted(time, t))
    before, after = sigma[max(at - BESIDE, 0) : at], sigma[at : at + BESIDE]
    return (np.median(after) - np.median(before)) / change > SUDDEN
