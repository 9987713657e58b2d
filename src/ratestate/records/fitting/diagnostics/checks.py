"""Checks of a fit against its record: whether the estimates and errors can be relied on."""

import numpy as np

from ....model.quantities import readable
from ...kit.regression import generalized_least_squares
from ...load_point.stress_steps import VARIABLE, stress_range
from ...messages import fitting as sentences
from ..generalized_least_squares import responds, response
from ..likelihood.transients import longest_distance
from ..record import before_changes, changes
from ..table import rate_dependence_text
from ..unknowns import NEAR, of_slider, parameter
from .identifiability import bounds_of, identifiability
from .left_out import left_out, rigid

#: slip after the last step, over Dc, after which friction is steady again
STEADY = 3.0
#: largest deviation of the mean normal stress from the slider's
OFF = 0.02
#: size of the residuals, over that of a given noise, that contradicts it
CONTRADICTED = 1.5
#: probability below which transients after the steps are not taken for noise
CHANCE = 0.01
#: errors of a trend from which it counts as one, and by which two trends that agree may differ
CLEAR, AGREE = 3.0, 2.0
#: side of a bound -> its name
SIDES = {-1: "lower", 1: "upper"}


def diagnose(inference, data):
    """A note on what a record determines (str), and warnings (list of str)."""
    solution = inference.solution
    if not responds(solution):
        warning = _no_response(solution)
        return f"Nothing is determined: {warning}.", [warning, *_normal_stress(solution, data)]
    note, warnings = identifiability(inference)
    return note, [
        *rigid(solution),  # first, for it explains others
        *search_warnings(inference),
        *warnings,
        *_ends_early(inference),
        *_misfit(inference),
        *_trend(inference),
        *_normal_stress(solution, data),
        *left_out(solution),
    ]


def _no_response(solution):
    """The warning that level and trend alone fit as well."""
    gain, free = response(solution)
    slider = solution.problem.slider
    alone = "alone_nearly" if gain > 0.0 else "alone_better"
    given = [s for s in of_slider(slider.friction_law) if s not in solution.unknowns.names]
    given = [s for s in given if s != "M" or slider.M > 0.0]
    return sentences(
        f"response.{'unsuited' if given else 'noise'}",
        trend="" if solution.problem.record.trend is None else " and a trend",
        alone=sentences(f"response.{alone}", gain=gain, free=free),
        given=", ".join(f"{s} = {readable(s, float(getattr(slider, s)))}" for s in given),
    )


def search_warnings(inference):
    """Warnings (str, one by one) on the search, on the posterior, and on estimates at a bound."""
    solution = inference.solution
    if not solution.converged:
        yield sentences("search.not_converged", evaluations=solution.evaluations)
    if inference.still_improving:
        yield sentences("search.still_improving")
    if inference.posterior is not None:
        yield from _posterior_warnings(inference.posterior, inference.quantities)
    coordinates = [q for q in inference.quantities if q.is_free]
    is_open = [q.name for q in coordinates if None in bounds_of(inference, q)]
    sides = solution.unknowns.sides(solution.point)
    for point, (name, side) in zip(solution.point, sides.items(), strict=True):
        if side and parameter(name).group == "start":
            which = "speed" if name == "V_start" else "state"
            yield sentences(f"start.{which}", name=name, ratio=np.exp(point), side=SIDES[side])
        elif side and name not in is_open and not _above_zero(inference, name, point):
            shown = readable(name, inference.estimates.of(name).value, 3)
            yield sentences("search.at_bound", name=name, value=shown, side=SIDES[side])


def _above_zero(inference, name, point):
    """Whether what cannot be negative is near to 0, but not for being held there."""
    return parameter(name).least == 0.0 and point > NEAR * inference.estimates.of(name).error


def _posterior_warnings(posterior, quantities):
    """Warnings on samples that are too few, or cut off by the prior."""
    if not posterior.complete:
        yield sentences("posterior.incomplete", evaluations=posterior.evaluations)
    if not posterior.reliable:
        yield sentences("posterior.unreliable", effective=posterior.effective)
    for quantity in quantities:
        if side := posterior.truncated_side(quantity):
            end = float(quantity.si(posterior.prior[quantity.name][side > 0]))
            yield sentences("posterior.truncated", name=quantity.name, side=SIDES[side], end=end)


def _ends_early(inference):
    """A warning if the record ends before friction is steady after the last step."""
    problem = inference.solution.problem
    name, D, high = longest_distance(inference.estimates, problem.slider)
    record, loading = problem.record, problem.record.loading
    last = max(changes(loading), default=0.0)
    slip = float(np.diff(loading.delta_lp(np.array([last, record.t[-1]])))[0])
    if loading.V[-1] == 0.0 or slip >= STEADY * high:
        return
    if slip >= STEADY * D:
        most = f"as large as {readable(name, high, 2)}" if np.isfinite(high) else "of any size"
        yield sentences("end.uncertain", slip=slip, name=name, most=most)
    else:
        yield sentences("end.early", slip=slip, name=name, over_D=slip / D, wanted=STEADY * D)


def is_misfit(inference):
    """Whether residuals are larger than the noise given, or have transients after steps."""
    return _over_given(inference.solution) >= CONTRADICTED or inference.chance < CHANCE


def _misfit(inference):
    """Warnings on residuals that are as `is_misfit` says."""
    solution = inference.solution
    if (ratio := _over_given(solution)) >= CONTRADICTED:
        yield sentences("residuals.above_noise", ratio=ratio)
    if inference.chance < CHANCE:
        massless = solution.problem.forward.fixed["M"] == 0.0
        mass = "the machine's mass (M is 0), " if massless else ""
        other = "another law"
        if len(solution.problem.law.states) == 1:
            other += ", such as two-state-aging or two-state-slip"
        yield sentences("residuals.after_steps", chance=inference.chance, mass=mass, other=other)
    elif np.isnan(inference.chance):
        yield sentences("residuals.not_tested")


def _over_given(solution):
    """Size of the residuals over that of the noise; about 1 where the noise was estimated."""
    return np.sqrt(solution.chi2 / solution.fitted_friction.size)


def without_trend(inference):
    """(p,) estimates [SI] if the trend is left out, to first order; None without a trend."""
    solution, names = inference.solution, inference.solution.unknowns.names
    if "trend" not in names:
        return None
    i = names.index("trend")
    lead = solution.covariance[:, i] / solution.covariance[i, i]
    point = solution.point - solution.point[i] * lead
    return np.array([quantity.si(quantity.value(point)) for quantity in inference.quantities])


def _trend(inference):
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
        is_own = quantity.is_free and parameter(quantity.name).group == "slider"
        error = estimates.of(quantity.name).error
        change = (value - estimates.of(quantity.name).value) / error
        if (is_own or quantity.name in names) and abs(change) > 1.0:
            name = names.get(quantity.name, quantity.name)
            moved.append(f"{name} = {readable(quantity.name, value, 3)} ({change:+.2g} errors)")
    if moved:
        value, error = readable(symbol, trend.value, 3), readable(symbol, trend.error, 2)
        yield sentences("trend.moves", value=value, error=error, moved=", ".join(moved))


def _is_seen_early(solution, trend):
    """Whether friction has this trend, and not none, before the first step."""
    record = solution.problem.record
    early = before_changes(record.loading, record.t)
    t, along = record.t[early], record.trend_variable[early]
    columns = np.column_stack([np.ones(t.size), along])
    try:
        line = generalized_least_squares(t, record.friction[early], columns, solution.noise)
    except np.linalg.LinAlgError:
        return False
    slope, error = line.coefficients[1], line.covariance[1, 1] ** 0.5
    is_same = abs(slope - trend.value) < AGREE * np.hypot(error, trend.error)
    return bool(is_same and abs(slope) > CLEAR * error)


def _normal_stress(solution, data):
    """Warnings if the recorded normal stress is not the slider's, or varies."""
    problem = solution.problem
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return
    recorded = np.asarray(data["sigma"].values, float)[problem.record.order]
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return
    followed, slider = problem.record.loading.normal_stress is not None, problem.slider
    mean = float(recorded.mean())
    stress = float(recorded[0]) if followed else mean  # it varies from the slider's on
    if abs(stress / slider.sigma - 1.0) > OFF:
        where = "at the start" if followed else "on average"
        yield sentences("normal_stress.other", stress=stress, where=where, sigma=slider.sigma)
    change = stress_range(data)
    if change > VARIABLE and not followed:
        yield sentences("normal_stress.unfollowed", percent=100.0 * change, mean=mean)
    elif change > VARIABLE and "alpha" not in solution.unknowns.names:
        yield sentences("normal_stress.varies", percent=100.0 * change, alpha=slider.alpha)
