"""Warnings on the search for the best fit, and on the samples of the posterior."""

from pathlib import Path

import numpy as np

from ....model.names import Sentences
from ....model.quantities import readable
from ..unknowns import NEAR, parameter, to_value
from .identifiability import bounds_of

SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))
#: side -> its name
SIDES = {-1: "lower", 1: "upper"}


def search_warnings(inference):
    """Warnings (str, one by one) on the search, on the posterior, and on estimates at a bound."""
    solution = inference.solution
    if not solution.converged:
        yield SENTENCES("search.not_converged", evaluations=solution.evaluations)
    if inference.still_improving:
        yield SENTENCES("search.still_improving")
    if inference.posterior is not None:
        yield from _posterior_warnings(inference.posterior, inference.quantities)
    coordinates = [q for q in inference.quantities if q.is_coordinate]
    is_open = [q.name for q in coordinates if None in bounds_of(inference, q)]
    sides = solution.unknowns.sides(solution.point)
    for point, (name, side) in zip(solution.point, sides.items(), strict=True):
        if side and parameter(name).group == "start":
            which = "speed" if name == "V_start" else "state"
            yield SENTENCES(f"start.{which}", name=name, ratio=np.exp(point), side=SIDES[side])
        elif side and name not in is_open and not _above_zero(inference, name, point):
            shown = readable(name, to_value(name, point), 3)
            yield SENTENCES("search.at_bound", name=name, value=shown, side=SIDES[side])


def _above_zero(inference, name, point):
    """Whether what cannot be negative is near to 0, but not for being held there."""
    return parameter(name).least == 0.0 and point > NEAR * inference.estimates.of(name).error


def _posterior_warnings(posterior, quantities):
    """Warnings on samples that are too few, or cut off by the prior."""
    if not posterior.complete:
        yield SENTENCES("posterior.incomplete", evaluations=posterior.evaluations)
    if not posterior.reliable:
        yield SENTENCES("posterior.unreliable", effective=posterior.effective)
    for quantity in quantities:
        if side := posterior.truncated_side(quantity):
            end = float(quantity.si(posterior.prior[quantity.name][side > 0]))
            yield SENTENCES("posterior.truncated", name=quantity.name, side=SIDES[side], end=end)
