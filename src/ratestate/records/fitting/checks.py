"""Warnings on a fit: whether its estimates and errors are reliable."""

import numpy as np

from ...model.quantities import readable
from ..kit.regression import generalized_least_squares
from ..load_point.stress_steps import VARIABLE, stress_range
from ..messages import fitting as sentences
from .by_law import rate_dependence_text
from .forward import Forward
from .identifiability import bounds_of, identifiability
from .inference import longest_distance
from .problem import before_first_change, change_times
from .quantities import SIDES
from .solutions import FALL, chi2_gain, responds, response
from .unknowns import motion_symbols, parameter

#: slip after the last step, divided by Dc, from which friction is steady
STEADY = 3.0
#: largest relative deviation of the mean normal stress from the slider's
STRESS_TOLERANCE = 0.02
#: residuals, divided by the given noise, that contradict this noise
CONTRADICTED = 1.5
#: significance level of transients after the steps
CHANCE = 0.01
#: standard errors by which a trend must differ from 0, and by which equal trends may differ
CLEAR, AGREE = 3.0, 2.0
#: values of K/sigma [1/m] that are tried for a rigid machine, from soft to stiff machines
STIFFNESSES = (1e3, 1e4, 1e5)
#: shortest and longest lag that are tried: per sample spacing, and per duration of the record
SHORTEST, LONGEST = 0.5, 1.0 / 30.0
#: eta with which the effect of inertia is tried
LIGHT = 1e-3
#: largest mass of a machine per area of the contact [kg/m^2], that of 100 m of steel: ten times the
#: length of the largest pistons, on a contact of a tenth of their section
HEAVIEST = 7850.0 * 100.0


def diagnose(inference, data):
    """Return a note on what a record determines (str), and warnings (list of str)."""
    solution = inference.solution
    if not responds(solution):
        warning = _no_response(solution)
        return f"Nothing is determined: {warning}.", [warning, *_normal_stress(solution, data)]
    note, warnings = identifiability(inference)
    return note, [
        *_rigid_machine(solution),  # first, because it may explain the others
        *search_warnings(inference),
        *warnings,
        *_ends_early(inference),
        *_misfit(inference),
        *_trend(inference),
        *_normal_stress(solution, data),
        *_left_out(solution),
    ]


def _no_response(solution):
    gain, free = response(solution)
    slider = solution.problem.slider
    alone = "alone_nearly" if gain > 0.0 else "alone_better"
    given = [s for s in motion_symbols(slider.friction_law) if s not in solution.unknowns.names]
    given = [s for s in given if s != "M" or slider.M > 0.0]
    return sentences(
        f"response.{'unsuited' if given else 'noise'}",
        trend="" if solution.problem.record.trend is None else " and a trend",
        alone=sentences(f"response.{alone}", gain=gain, free=free),
        given=", ".join(f"{s} = {readable(s, float(getattr(slider, s)))}" for s in given),
    )


def search_warnings(inference):
    """Yield warnings on the search, the posterior, and estimates at a bound."""
    solution = inference.solution
    if not solution.converged:
        yield sentences("search.not_converged", evaluations=solution.evaluations)
    if inference.still_improving:
        yield sentences("search.still_improving")
    if inference.posterior is not None:
        yield from _posterior_warnings(inference.posterior, inference.quantities)
    coordinates = [q for q in inference.quantities if q.is_free]
    is_open = [q.name for q in coordinates if None in bounds_of(inference, q)]
    for point, (name, side) in zip(solution.point, solution.sides.items(), strict=True):
        if side and parameter(name).group == "start":
            values = {"ratio": np.exp(point), "side": SIDES[side > 0]}
            yield sentences("search.start_at_bound", name=name, **values)
        elif side and name not in is_open:
            shown = readable(name, inference.estimates.by_name[name].value, 3)
            yield sentences("search.at_bound", name=name, value=shown, side=SIDES[side > 0])


def _posterior_warnings(posterior, quantities):
    if not posterior.complete:
        yield sentences("posterior.incomplete", evaluations=posterior.evaluations)
    if not posterior.reliable:
        yield sentences("posterior.unreliable", effective=posterior.effective)
    for quantity in quantities:
        if side := posterior.truncated_side(quantity):
            end = float(quantity.si(posterior.prior[quantity.name][side > 0]))
            values = {"side": SIDES[side > 0], "end": end}
            yield sentences("posterior.truncated", name=quantity.name, **values)


def _ends_early(inference):
    problem = inference.solution.problem
    name, D, high = longest_distance(inference.estimates, problem.slider)
    record, loading = problem.record, problem.record.loading
    changes = change_times(loading)
    within = changes[changes < record.t[-1]]  # a ramp of normal stress may end with the record
    last = max(within, default=0.0)
    slip = float(np.diff(loading.delta_lp(np.array([last, record.t[-1]])))[0])
    if loading.V[-1] == 0.0 or slip >= STEADY * high:
        return
    if slip >= STEADY * D:
        most = f"as large as {readable(name, high, 2)}" if np.isfinite(high) else "of any size"
        yield sentences("end.uncertain", slip=slip, name=name, most=most)
    else:
        yield sentences("end.early", slip=slip, name=name, over_D=slip / D, wanted=STEADY * D)


def is_misfit(inference):
    """Return whether residuals exceed the given noise, or have transients."""
    return _noise_ratio(inference.solution) >= CONTRADICTED or inference.p_value < CHANCE


def _misfit(inference):
    solution = inference.solution
    if (ratio := _noise_ratio(solution)) >= CONTRADICTED:
        yield sentences("residuals.above_noise", ratio=ratio)
    if inference.p_value < CHANCE:
        massless = solution.problem.forward.fixed["M"] == 0.0
        mass = "give the machine's mass (M is 0), " if massless else ""
        is_simple = len(solution.problem.law.states) == 1
        values = {"laws": ", such as two-state-aging or two-state-slip" if is_simple else ""}
        yield sentences("residuals.after_steps", chance=inference.p_value, mass=mass, **values)
    elif np.isnan(inference.p_value):
        yield sentences("residuals.not_tested")


def _noise_ratio(solution):  # about 1 if the noise was estimated
    return np.sqrt(solution.chi2 / solution.fitted_friction.size)


def without_trend(inference):
    """Return estimates (p,) [SI] without the trend, to first order; None if no trend."""
    solution, (names, low, high) = inference.solution, inference.solution.unknowns
    if "trend" not in names:
        return None
    i = names.index("trend")
    lead = solution.covariance[:, i] / solution.covariance[i, i]
    point = np.clip(solution.point - solution.point[i] * lead, low, high)
    return np.array([quantity.si(quantity.value(point)) for quantity in inference.quantities])


def _trend(inference):
    """Yield a warning if an unconfirmed trend moves estimates by more than errors.

    A trend is confirmed if friction before the first step has it as well.
    """
    solution, estimates = inference.solution, inference.estimates
    if (values := without_trend(inference)) is None:
        return
    symbol = f"trend_{solution.problem.record.trend}"
    trend = estimates.by_name[symbol]
    if abs(trend.value) < CLEAR * trend.error or _is_confirmed_before_steps(solution, trend):
        return
    names, moved = {"a_minus_b": rate_dependence_text([solution.problem.law])}, []
    for quantity, value in zip(inference.quantities, values, strict=True):
        is_own = quantity.is_free and parameter(quantity.name).group == "slider"
        error = estimates.by_name[quantity.name].error
        change = (value - estimates.by_name[quantity.name].value) / error
        if (is_own or quantity.name in names) and abs(change) > 1.0:
            name = names.get(quantity.name, quantity.name)
            moved.append(f"{name} = {readable(quantity.name, value, 3)} ({change:+.2g} errors)")
    if moved:
        value, error = readable(symbol, trend.value, 3), readable(symbol, trend.error, 2)
        yield sentences("trend.moves", value=value, error=error, moved=", ".join(moved))


def _is_confirmed_before_steps(solution, trend):
    """Return whether friction before the first step has this trend, clearly not 0."""
    record = solution.problem.record
    early = before_first_change(record.loading, record.t)
    t, along = record.t[early], record.trend_variable[early]
    columns = np.column_stack([np.ones(t.size), along])
    try:
        values, covariance = generalized_least_squares(
            t, record.friction[early], columns, solution.noise
        )
    except np.linalg.LinAlgError:
        return False
    slope, error = values[1], covariance[1, 1] ** 0.5
    is_same = abs(slope - trend.value) < AGREE * np.hypot(error, trend.error)
    return bool(is_same and abs(slope) > CLEAR * error)


def _normal_stress(solution, data):
    problem = solution.problem
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return
    recorded = np.asarray(data["sigma"].values, float)
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return
    followed, slider = problem.record.loading.normal_stress is not None, problem.slider
    mean = float(recorded.mean())
    stress = float(recorded[0]) if followed else mean  # the model begins with the slider's
    if abs(stress / slider.sigma - 1.0) > STRESS_TOLERANCE:
        where = "at the start" if followed else "on average"
        yield sentences("normal_stress.other", stress=stress, where=where, sigma=slider.sigma)
    change = stress_range(data)
    if change > VARIABLE and not followed:
        yield sentences("normal_stress.unfollowed", percent=100.0 * change, mean=mean)
    elif change > VARIABLE and "alpha" not in solution.unknowns.names:
        yield sentences("normal_stress.varies", percent=100.0 * change, alpha=slider.alpha)


def _rigid_machine(solution):
    """Yield a warning if K = inf was given and a spring or a lag would fit better.

    If a spring does, the warning names the load point as well.  Seen from the poor fit of a rigid
    machine, a load point that moves later or more gradually explains as much.
    """
    record, slider = solution.problem.record, solution.problem.slider
    if np.isfinite(slider.K):
        return
    sprung = [slider.replace(K=K * slider.sigma, M=0.0) for K in STIFFNESSES]
    frictions = [_friction_of(softer, solution) for softer in sprung]
    gain, _ = max(_gains(solution, frictions, STIFFNESSES))
    if gain > FALL:
        yield sentences("rigid.sprung", gain=gain)
    elif "lag" not in solution.unknowns.names:
        # friction of a rigid machine jumps, and so has no derivative by the lag
        octaves = np.log2(LONGEST * record.t[-1] / (SHORTEST * record.spacing))
        lags = SHORTEST * record.spacing * 2.0 ** np.arange(0.0, octaves, 0.5)
        lags = np.concatenate([lags, -lags])
        found = _gains(solution, _friction_at_lags(solution, lags), lags.tolist())
        gain, lag = max(found, default=(0.0, 0.0))  # a record may be too short for any lag
        if gain > FALL:
            yield sentences("rigid.lag", lag=abs(lag), side=_side(lag), gain=gain)


def _left_out(solution):
    """Yield warnings if a lag or inertia would lower chi-square by more than chance does.

    Inertia is not mentioned if it requires a mass that no machine has: then something else is
    wrong.
    """
    problem, slider = solution.problem, solution.problem.slider
    if not np.isfinite(slider.K):  # see `_rigid_machine`
        return
    if "lag" not in solution.unknowns.names:
        step = parameter("lag").step(problem.record, 1.0)
        later, earlier = _friction_at_lags(solution, np.array([step, -step]))
        gain, lag = _gain(solution, (later - earlier) / (2.0 * step))
        if gain > FALL:
            yield sentences("more.lag", lag=abs(lag), side=_side(lag), gain=gain)
    if slider.M == 0.0:
        at = problem.forward.values(solution.point[None])
        unit = float(at["a"][0] * slider.sigma * at["Dc"][0]) / problem.record.loading.V.max() ** 2
        change = _friction_of(slider.replace(M=LIGHT * unit), solution) - solution.fitted_friction
        gain, eta = _gain(solution, change / LIGHT)
        if gain > FALL and eta > LIGHT and eta * unit < HEAVIEST:
            yield sentences("more.inertia", gain=gain, unit=unit)


def _friction_of(slider, solution):
    """Return friction (m,) of another slider at the coordinates of a solution."""
    forward = Forward(solution.problem.record, slider, solution.unknowns.names)
    return forward.friction(solution.point[None])[0]


def _friction_at_lags(solution, lags):
    """Return friction (n, m) with these lags [s] of the load point besides the coordinates."""
    problem = solution.problem
    forward = Forward(problem.record, problem.slider, (*solution.unknowns.names, "lag"))
    return forward.friction(np.column_stack([np.tile(solution.point, (lags.size, 1)), lags]))


def _gain(solution, change):
    """Return the fall of chi-square by a multiple of this change of friction, and the multiple."""
    gain, (multiple,) = chi2_gain(solution, np.nan_to_num(change)[:, None])  # NaN: no motion
    return gain, multiple


def _gains(solution, frictions, values):
    """Yield the fall of chi-square by part of the way to each friction, and its value."""
    for friction, value in zip(frictions, values, strict=True):
        gain, part = _gain(solution, friction - solution.fitted_friction)
        yield gain if part > 0.0 else 0.0, value


def _side(lag):
    return "later" if lag > 0.0 else "earlier"
