"""Checks of a fit against its record: whether the estimates and errors can be relied on."""

import numpy as np
from scipy.special import fdtrc

from ....model.quantities import readable
from ..forward import Forward
from ..score import CHANCE, FALL, gain_of, responds, response
from .identifiability import identifiability

#: slip after the last step, over Dc, after which friction is steady again
STEADY = 3.0
#: largest deviation of the normal stress from the slider's, and its largest standard deviation
OFF, VARIABLE = 0.02, 0.01
#: variance of residuals over that of white noise, and correlation time over Dc/V, from which
#: correlated residuals count as misfit
COLORED, LONG = 4.0, 0.1
#: mean square of whitened residuals after steps that is misfit; slip after a step, over Dc, that
#: counts as after it
MISFIT, AFTER = 1.5, 5.0
#: eta of the mass with which the effect of inertia is tried
LIGHT = 1e-3
#: fewest samples elsewhere from which the noise is inference
FEWEST = 30
#: size of the residuals, over that of a given noise, that contradicts it
CONTRADICTED = 1.5
#: residuals, over friction's range, too small to be a misfit
FINE = 1e-4


def diagnose(inference, data, slider):
    """A note on what a record determines (str), and warnings (list of str).

    Parameters
    ----------
    inference : Inference
    data : xarray.Dataset, the record
    slider : SpringSlider
    """
    noise_only = _no_response(inference, slider)
    if noise_only:
        return f"Nothing is determined: {noise_only[0]}.", noise_only
    note, warnings = identifiability(inference)
    warnings += [
        *_ends_early(inference, slider),
        *_noise_too_small(inference),
        *_misfit(inference, slider),
        *_normal_stress(inference, data, slider),
        *_better_with_more(inference, slider),
    ]
    return note, warnings


def _no_response(inference, slider):
    """A warning if level and trend alone fit as well."""
    if responds(inference.solution):
        return []
    gain, free = response(inference.solution)
    names = inference.solution.unknowns.names
    given = [symbol for symbol in ("a", "b", "Dc", "K") if symbol not in names]
    given += ["M"] if "M" not in names and slider.M > 0.0 else []
    also = "" if inference.solution.problem.record.trend is None else " and a trend"
    alone = (
        f"alone fit nearly as well (chi-square differs by {gain:.3g} for {free} parameters)"
        if gain > 0.0
        else "alone fit better than any of these sliders"
    )
    if given:
        values = ", ".join(f"{s} = {readable(s, float(getattr(slider, s)))}" for s in given)
        return [
            f"friction does not respond to the steps as it should: a level{also} {alone}; either "
            f"there is only noise, or what was given does not suit the record ({values}): free it, "
            f"or check it"
        ]
    return [
        f"friction does not respond to the steps by more than the noise: a level{also} {alone}; "
        f"the estimates are those of noise: use another record, or a window about a larger step"
    ]


def _value(inference, name, slider):
    """A parameter's estimate, or its value if it was given."""
    table = inference.estimates
    return float(
        table.values[table.names.index(name)] if name in table.names else getattr(slider, name)
    )


def _upper_end(inference, name, given):
    """The upper end of a parameter's 95 % interval, or its value if it was given."""
    table = inference.estimates
    return float(table.intervals[table.names.index(name), -1, 1]) if name in table.names else given


def _ends_early(inference, slider):
    """A warning if the record ends before friction is steady after the last step."""
    record = inference.solution.problem.record
    Dc = _value(inference, "Dc", slider)
    slip = np.diff(record.loading.delta_lp(np.array([record.loading.t[-1], record.t[-1]])))[0]
    high = _upper_end(inference, "Dc", Dc)
    if record.loading.V[-1] == 0.0 or slip >= STEADY * high:
        return []
    if slip >= STEADY * Dc:
        most = f"as large as {readable('Dc', high, 2)}" if np.isfinite(high) else "of any size"
        return [
            f"the record ends {readable('delta_lp', float(slip), 3)} after its last step, and Dc "
            f"may be {most} (95 %): friction may not be steady by then; widen the window"
        ]
    return [
        f"the record ends {readable('delta_lp', float(slip), 3)} after its last step, only "
        f"{slip / Dc:.2g} Dc, before friction is steady: b, Dc and a - b rest on what was not "
        f"recorded; widen the window to {readable('delta_lp', STEADY * Dc, 2)} or more after the "
        f"step"
    ]


def _noise_too_small(inference):
    """A warning if residuals are much larger than the noise that was given."""
    solution = inference.solution
    ratio = np.sqrt(solution.chi2 / solution.fitted_friction.size)
    if ratio < CONTRADICTED:
        return []
    return [
        f"residuals are {ratio:.2g} times as large as the noise that was given; all errors are too "
        f"small by as much: leave noise out, and it is estimated"
    ]


def _misfit(inference, slider):
    """A warning if residuals are larger after steps, or last about as long as a transient."""
    solution = inference.solution
    record, noise = solution.problem.record, solution.noise
    Dc = _value(inference, "Dc", slider)
    residual = record.friction - solution.fitted_friction
    white, _ = noise.whiten(record.t, residual)
    after = np.zeros(record.t.size, bool)
    loading = record.loading
    durations = Dc / np.maximum(loading.V[1:], 1e-3 * loading.V.max())
    for t, duration in zip(loading.t[1:], durations, strict=True):
        after |= (record.t >= t) & (record.t < t + AFTER * duration)
    count = int(after.sum())
    if not count or np.sqrt(np.mean(residual[after] ** 2)) < FINE * record.scale:
        return []
    others = after.size - count
    elsewhere = float(np.mean(white[~after, 0] ** 2)) if others > FEWEST else np.inf
    square = float(np.mean(white[after, 0] ** 2)) / elsewhere
    mass = "the machine's mass (M is 0), " if solution.problem.forward.fixed["M"] == 0.0 else ""
    if square > MISFIT and fdtrc(count, others, square) < CHANCE:
        return [
            f"the law does not describe the record after its steps: residuals there are "
            f"{np.sqrt(square):.2g} times as large as the noise elsewhere; the errors count them "
            f"as noise, and are too small: try the other law, {mass}lag among free, or a window "
            f"that leaves out what is special"
        ]
    colored = float(np.mean(residual**2)) / (np.var(np.diff(residual)) / 2.0)
    duration = float(durations.min())
    if noise.red and colored > COLORED and noise.time > LONG * duration:
        return [
            f"residuals of {noise.red:.2g} are correlated over {readable('t', noise.time, 3)}, "
            f"not short beside the transient (Dc/V = {readable('t', duration, 3)}): the "
            f"machine's noise, or something that the law does not describe; the errors count it "
            f"as noise: look at the residuals, and try the other law"
        ]
    return []


def _normal_stress(inference, data, slider):
    """Warnings if the recorded normal stress is not the slider's, or not constant."""
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return []
    recorded = np.asarray(data["sigma"].values, float)[inference.solution.problem.record.order]
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return []
    mean, warnings = float(recorded.mean()), []
    shown = readable("sigma", mean)
    if abs(mean / slider.sigma - 1.0) > OFF:
        warnings.append(
            f"the recorded normal stress is {shown} on average, the slider's "
            f"{readable('sigma', slider.sigma)}: K and M are in proportion to it; fit with "
            f"slider.replace(sigma='{shown}')"
        )
    if recorded.std() > VARIABLE * mean:
        warnings.append(
            f"the recorded normal stress varies by {100 * recorded.std() / mean:.2g} % (standard "
            f"deviation) about {shown}; the model holds it constant: choose a window in which it is"
        )
    return warnings


def _better_with_more(inference, slider):
    """Warnings if a lag, or inertia, would lower chi-square by more than chance does."""
    solution = inference.solution
    record, law = solution.problem.record, solution.problem.forward.law
    names = solution.unknowns.names
    warnings = []
    if "lag" not in names:
        forward = Forward(record, slider, law, (*names, "lag"))
        step = forward.steps["lag"]
        points = np.array([np.append(solution.point, lag) for lag in (step, -step)])
        above, below = forward.friction(points)
        gain, (lag,) = gain_of(solution, np.nan_to_num((above - below) / (2.0 * step))[:, None])
        if gain > FALL:
            warnings.append(
                f"a load point that moves {readable('t', abs(lag), 3)} "
                f"{'later' if lag > 0.0 else 'earlier'} than recorded would lower chi-square by "
                f"about {gain:.3g}: add 'lag' to free, or look at the clock"
            )
    if slider.M == 0.0 and np.isfinite(slider.K):
        at = solution.problem.forward.values(solution.point[None])
        unit = float(at["a"][0] * slider.sigma * at["Dc"][0]) / record.loading.V.max() ** 2
        forward = Forward(record, slider.replace(M=LIGHT * unit), law, names)
        heavy = forward.friction(solution.point[None])[0]
        by_eta = np.nan_to_num((heavy - solution.fitted_friction) / LIGHT)
        gain, (eta,) = gain_of(solution, by_eta[:, None])
        if gain > FALL and eta > LIGHT:
            warnings.append(
                f"inertia would lower chi-square by about {gain:.3g}: give the slider its mass M "
                f"(eta = 1 at the largest speed is M = {unit:.3g} kg/m^2), or free it; M = 0 was "
                f"assumed"
            )
    return warnings
