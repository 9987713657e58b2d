"""What in a record speaks against taking a fit at its word."""

import numpy as np
from scipy.special import fdtrc

from ....model.quantities import readable
from ..forward import Forward
from ..score import CHANCE, FALL, gain_of, responds, response
from .identify import identified

#: slip after the last step, in Dc, before which friction has not settled
SETTLED = 3.0
#: of the normal stress: how far off from the slider's, and how variable it may be
OFF, VARIABLE = 0.02, 0.01
#: variance of residuals over that of white noise, and correlation time over Dc/V, that are misfit
COLORED, LONG = 4.0, 0.1
#: of whitened residuals after steps, the mean square that is misfit; slip that counts, in Dc
MISFIT, AFTER = 1.5, 5.0
#: eta of the mass by which it is tried whether inertia helps
LIGHT = 1e-3
#: samples elsewhere that tell what the noise is
FEWEST = 30
#: of residuals, the size over that of a given noise that contradicts it
UNDERSTATED = 1.5
#: residuals, in parts of friction's range, that are no misfit of anything
FINE = 1e-4


def in_words(known, data, slider):
    """Words on what a record determines, and warnings (list of str).

    Parameters
    ----------
    known : Uncertain
    data : xarray.Dataset, the record
    slider : SpringSlider
    """
    noise_only = _unresponsive(known, slider)
    if noise_only:
        return f"Nothing is determined: {noise_only[0]}.", noise_only
    words, warnings = identified(known)
    warnings += [
        *_unsettled(known, slider),
        *_understated(known),
        *_misfit(known, slider),
        *_normal_stress(known, data, slider),
        *_better_with(known, slider),
    ]
    return words, warnings


def _unresponsive(known, slider):
    """Whether level and trend alone fit as well."""
    if responds(known.solution):
        return []
    gain, free = response(known.solution)
    names = known.solution.unknowns.names
    given = [symbol for symbol in ("a", "b", "Dc", "K") if symbol not in names]
    given += ["M"] if "M" not in names and slider.M > 0.0 else []
    also = "" if known.solution.problem.record.trend is None else " and a trend"
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


def _value(known, name, slider):
    table = known.estimates
    return float(
        table.values[table.names.index(name)] if name in table.names else getattr(slider, name)
    )


def _upper(known, name, otherwise):
    """The upper end of a parameter's 95 % interval; its value if it was given."""
    table = known.estimates
    return (
        float(table.intervals[table.names.index(name), -1, 1]) if name in table.names else otherwise
    )


def _unsettled(known, slider):
    """Whether the record ends soon after its last step."""
    record = known.solution.problem.record
    Dc = _value(known, "Dc", slider)
    passed = np.diff(record.loading.delta_lp(np.array([record.loading.t[-1], record.t[-1]])))[0]
    high = _upper(known, "Dc", Dc)
    if record.loading.V[-1] == 0.0 or passed >= SETTLED * high:
        return []
    if passed >= SETTLED * Dc:
        most = f"as large as {readable('Dc', high, 2)}" if np.isfinite(high) else "of any size"
        return [
            f"the record ends {readable('delta_lp', float(passed), 3)} after its last step, and Dc "
            f"may be {most} (95 %): friction may not have settled by then; widen the window"
        ]
    return [
        f"the record ends {readable('delta_lp', float(passed), 3)} after its last step, only "
        f"{passed / Dc:.2g} Dc, before friction has settled: b, Dc and a - b rest on what was not "
        f"seen; widen the window to {readable('delta_lp', SETTLED * Dc, 2)} or more after the step"
    ]


def _understated(known):
    """Whether residuals are much larger than the noise that was given."""
    solution = known.solution
    ratio = np.sqrt(solution.chi2 / solution.fitted.size)
    if ratio < UNDERSTATED:
        return []
    return [
        f"residuals are {ratio:.2g} times as large as the noise that was given; all errors are too "
        f"small by as much: leave noise out, and it is estimated"
    ]


def _misfit(known, slider):
    """Whether residuals are larger after steps than noise is, or of a transient's duration."""
    solution = known.solution
    record, noise = solution.problem.record, solution.noise
    Dc = _value(known, "Dc", slider)
    residual = record.friction - solution.fitted
    white, _ = noise.whiten(record.t, residual)
    after = np.zeros(record.t.size, bool)
    loading = record.loading
    durations = Dc / np.maximum(loading.V[1:], 1e-3 * loading.V.max())
    for t, duration in zip(loading.t[1:], durations, strict=True):
        after |= (record.t >= t) & (record.t < t + AFTER * duration)
    count = int(after.sum())
    if not count or np.sqrt(np.mean(residual[after] ** 2)) < FINE * record.scale:
        return []
    beside = after.size - count
    elsewhere = float(np.mean(white[~after, 0] ** 2)) if beside > FEWEST else np.inf
    square = float(np.mean(white[after, 0] ** 2)) / elsewhere
    mass = "the machine's mass (M is 0), " if solution.problem.forward.fixed["M"] == 0.0 else ""
    if square > MISFIT and fdtrc(count, beside, square) < CHANCE:
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


def _normal_stress(known, data, slider):
    """Whether the recorded normal stress is the slider's, and constant."""
    if "sigma" not in data.variables or data["sigma"].dims != ("time",):
        return []
    recorded = np.asarray(data["sigma"].values, float)[known.solution.problem.record.order]
    recorded = recorded[np.isfinite(recorded)]
    if not recorded.size:
        return []
    mean, found = float(recorded.mean()), []
    shown = readable("sigma", mean)
    if abs(mean / slider.sigma - 1.0) > OFF:
        found.append(
            f"the recorded normal stress is {shown} on average, the slider's "
            f"{readable('sigma', slider.sigma)}: K and M are in proportion to it; fit with "
            f"slider.replace(sigma='{shown}')"
        )
    if recorded.std() > VARIABLE * mean:
        found.append(
            f"the recorded normal stress varies by {100 * recorded.std() / mean:.2g} % (standard "
            f"deviation) about {shown}; the model holds it constant: choose a window in which it is"
        )
    return found


def _better_with(known, slider):
    """Whether a lag, or inertia, would lower chi-square by more than chance does."""
    solution = known.solution
    record, law = solution.problem.record, solution.problem.forward.law
    names = solution.unknowns.names
    found = []
    if "lag" not in names:
        forward = Forward(record, slider, law, (*names, "lag"))
        step = forward.steps["lag"]
        points = np.array([np.append(solution.point, lag) for lag in (step, -step)])
        above, below = forward.friction(points)
        gain, (lag,) = gain_of(solution, np.nan_to_num((above - below) / (2.0 * step))[:, None])
        if gain > FALL:
            found.append(
                f"a load point that moves {readable('t', abs(lag), 3)} "
                f"{'later' if lag > 0.0 else 'earlier'} than recorded would lower chi-square by "
                f"about {gain:.3g}: add 'lag' to free, or look at the clock"
            )
    if slider.M == 0.0 and np.isfinite(slider.K):
        at = solution.problem.forward.values(solution.point[None])
        unit = float(at["a"][0] * slider.sigma * at["Dc"][0]) / record.loading.V.max() ** 2
        forward = Forward(record, slider.replace(M=LIGHT * unit), law, names)
        heavy = forward.friction(solution.point[None])[0]
        gain, (eta,) = gain_of(solution, np.nan_to_num((heavy - solution.fitted) / LIGHT)[:, None])
        if gain > FALL and eta > LIGHT:
            found.append(
                f"inertia would lower chi-square by about {gain:.3g}: give the slider its mass M "
                f"(eta = 1 at the largest speed is M = {unit:.3g} kg/m^2), or free it; M = 0 was "
                f"assumed"
            )
    return found
