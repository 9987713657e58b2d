"""How much the estimates depend on the trend of friction."""

from pathlib import Path

import numpy as np

from ....model.names import Sentences
from ....model.quantities import readable
from ...kit.regression import generalized_least_squares
from ..record import before_changes
from ..table import rate_dependence_text
from ..unknowns import parameter

#: errors of a trend from which it counts as one, and by which two trends that agree may differ
CLEAR, AGREE = 3.0, 2.0
SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))


def without_trend(inference):
    """(p,) estimates [SI] if the trend is left out, to first order; None without a trend."""
    solution, names = inference.solution, inference.solution.unknowns.names
    if "trend" not in names:
        return None
    i = names.index("trend")
    lead = solution.covariance[:, i] / solution.covariance[i, i]
    point = solution.point - solution.point[i] * lead
    return np.array([quantity.si(quantity.value(point)) for quantity in inference.quantities])


def trend_warnings(inference):
    """A warning if the trend moves estimates by more than their errors, and may not be a trend.

    It is one if friction has it before the first step, too.
    """
    solution, estimates = inference.solution, inference.estimates
    if (values := without_trend(inference)) is None:
        return
    symbol = parameter("trend").reported_as.format(along=solution.problem.record.trend)
    trend = estimates.of(symbol)
    if abs(trend.value) < CLEAR * trend.error or _is_seen_early(solution, trend):
        return
    names, moved = {"a_minus_b": rate_dependence_text([solution.problem.law])}, []
    for quantity, value in zip(inference.quantities, values, strict=True):
        is_own = quantity.is_coordinate and parameter(quantity.name).group == "slider"
        error = estimates.of(quantity.name).error
        change = (value - estimates.of(quantity.name).value) / error
        if (is_own or quantity.name in names) and abs(change) > 1.0:
            name = names.get(quantity.name, quantity.name)
            moved.append(f"{name} = {readable(quantity.name, value, 3)} ({change:+.2g} errors)")
    if moved:
        value, error = readable(symbol, trend.value, 3), readable(symbol, trend.error, 2)
        yield SENTENCES("trend.moves", value=value, error=error, moved=", ".join(moved))


def _is_seen_early(solution, trend):
    """Whether friction has this trend, and not none, before the first step."""
    record = solution.problem.record
    early = before_changes(record.loading, record.t)
    columns = np.column_stack([np.ones(early.sum()), record.trend_variable[early]])
    try:
        line = generalized_least_squares(
            record.t[early], record.friction[early], columns, solution.noise
        )
    except np.linalg.LinAlgError:
        return False
    slope, error = line.coefficients[1], line.covariance[1, 1] ** 0.5
    is_same = abs(slope - trend.value) < AGREE * np.hypot(error, trend.error)
    return bool(is_same and abs(slope) > CLEAR * error)
