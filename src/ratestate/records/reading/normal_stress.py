"""Steps of the normal stress in a record."""

from typing import NamedTuple

import numpy as np

from ...model.quantities import power_of, prefixed_unit
from .segments import segments_from_velocity, time_text

#: standard deviation, over the mean, from which it counts as varying
VARIABLE = 0.01
#: rows on either side of a step, between which most of the change happens
BESIDE, SUDDEN = 5, 0.6


class StressStep(NamedTuple):
    """A sudden change between two levels of normal stress."""

    t: float  # [s]
    before: float  # [Pa]
    after: float


def varies(sigma):
    """Whether a normal stress (n,) is finite everywhere and varies."""
    return bool(np.isfinite(sigma).all() and sigma.std() > VARIABLE * sigma.mean())


def stress_steps(time, sigma):
    """list of `StressStep` of a normal stress (n,) [Pa] at times (n,) [s]; of slow changes none."""
    if not varies(sigma):
        return []
    # (levels of stress are found as constant speeds are)
    levels = segments_from_velocity(time, sigma)
    pairs = zip(levels.t[1:].tolist(), levels.V[:-1].tolist(), levels.V[1:].tolist(), strict=True)
    return [StressStep(*one) for one in pairs if _is_sudden(time, sigma, *one)]


def _is_sudden(time, sigma, t, before, after):
    """Whether a change of normal stress between two levels happens within some rows."""
    at = int(np.searchsorted(time, t))
    sides = sigma[max(at - BESIDE, 0) : at], sigma[at : at + BESIDE]
    return (np.median(sides[1]) - np.median(sides[0])) / (after - before) > SUDDEN


def stress_text(step):
    """Such as "step of normal stress 8.00 -> 8.80 MPa at 150.0 s"."""
    power = power_of("Pa", max(step.before, step.after))
    before, after = (f"{x / 10.0**power:#.3g}" for x in (step.before, step.after))
    levels = f"{before} -> {after} {prefixed_unit('Pa', power)}"
    return f"step of normal stress {levels} at {time_text(step.t)}"
