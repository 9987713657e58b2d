"""Loading and unloading of the spring in a record, and the fitted curves of friction.

At constant state, quasi-static friction is mu = mu_1 + a ln(V/V_1).  With dtau/dt = K (V_lp - V) it
depends on the load point's displacement x as

    mu(x) = mu_0 - a ln(r + (1 - r) exp(-k x/a)),   k = K/sigma,

with r = V/V_lp and mu = mu_0, the level before, at x = 0.  The slope there is k (1 - r), which is
less than k because the fault creeps.  After a step, r follows from steady sliding at the speed
before.  After a hold, V at its end follows from the relaxation, dmu/dt = -k V.  With r = 0 the
curve is a straight line.  The relaxation is fitted with a quadratic in the logarithm of time.  A
line would give the mean V over the fitted times, which is a few per cent too large.

After a hold the fault continues to heal while the spring loads.  Friction increases by h per unit
of x, so the fault creeps less.  Then mu - h x follows the same curve, with k replaced by k - h, and
r by r k/(k - h).  Friction heals with the logarithm of time, so h is the healing per e-fold of time
divided by the displacement that the load point would have made during the hold.

The parameter a and the rate of healing have small effects.  They are assumed to be typical of rocks
and gouges, to a factor of about two: a is 0.008, and friction heals by 0.008 per decade (Marone
1998 doi:10.1146/annurev.earth.26.1.643).

The coordinates p of a curve are mu_0, ln k, ln a, x_0 (the shift of the start of loading, in its
standard errors), and ln of healing divided by its assumed value.  After a hold, two more are the
slope and the curvature of the relaxation.
"""

from typing import NamedTuple

import numpy as np
import scipy

from ..kit.noise import Noise, RestrictedLikelihood, estimated_noise
from ..kit.regression import central_differences, fall_of_chi2
from ..kit.sample_noise import sample_noise

#: fall of chi-square by a quadratic and a cubic term that 1 of 1000 fits exceeds by chance
SIGNIFICANT = 13.82
#: assumed a and healing per e-fold of time; standard deviation of their logarithms
A, HEALING, LOG_ERROR = 0.008, 0.0035, 0.6
#: largest h/k; smallest and largest r after a hold
MOST_HEALING, CREEP = 0.5, (1e-12, 0.9)
#: largest change of p in the search: for k a factor of 7, for others 8 standard deviations
MAX_STEP = np.array([np.inf, 2.0, 8.0 * LOG_ERROR, 8.0, 8.0 * LOG_ERROR, np.inf, np.inf])
#: rounds of noise and fit; most evaluations; step of a difference
ROUNDS, EVALUATIONS, STEP = 3, 100, 1e-5
#: fraction of the change of friction up to the extremum that is fitted; fitted part of the time
#: between two stress drops
UNTIL, STICK = 0.6, (0.2, 0.6)
#: fewest samples of a slope, before it, and between stress drops; least change of friction, as a
#: multiple of its noise
FEWEST, FEWEST_BEFORE, FEWEST_BETWEEN, LEAST = 4, 4, 12, 8.0
#: final fraction of the slide before that gives the level and its noise; its most samples
LEVEL_PART, MOST_BEFORE = 0.1, 500
#: final fraction of a hold that gives the relaxation; most samples before the last `MOST_BEFORE`
HOLD_PART, MOST_EARLY = 0.5, 1000
#: standard error of ln K due to the change of state during loading, of the size of the errors of
#: noiseless slopes under both laws at k Dc from 1e-3 to 0.1.  Apart from healing, these errors are
#: at most 5e-4 after holds, 6e-3 after steps up by a factor of 3 and 10, and 3e-2 after steps down
#: by a factor of 3.
STATE_ERROR = {"reload": 5e-4, "step_up": 4e-3, "step_down": 2e-2}


class Slope(NamedTuple):
    """A loading or unloading of the spring, and the curve fitted to it."""

    point: np.ndarray  # (7,) coordinates
    independent_error: float  # error of ln k from causes that differ between slopes
    shared_error: float  # error of ln k from causes that slopes share: a, healing, change of state
    misfit: float  # fall of chi-square if a quadratic and a cubic are added to the curve
    r: float  # V/V_lp when loading begins
    straight: float  # slope of the best straight line through the curve [1/m]
    fitted: np.ndarray  # fitted friction of the rows
    kind: str = ""
    start: float = np.nan  # time at which x = 0 [s]
    rows: np.ndarray | None = None  # fitted samples, including those before the start

    @property
    def k(self):
        """Return K divided by the normal stress [1/m]."""
        return float(np.exp(self.point[1]))

    @property
    def k_error(self):
        return self.k * float(np.hypot(self.independent_error, self.shared_error))

    @property
    def is_explained(self):
        """Return whether the curve explains the samples."""
        return self.misfit < SIGNIFICANT


def curve(x, mu_0, k, a, r, healing=0.0):
    """Return mu(x) of the equation above; mu_0 if x < 0."""
    x = np.maximum(x, 0.0)
    if r == 0.0:
        return mu_0 + k * x
    rest = k - healing
    r = r * k / rest
    return mu_0 + healing * x - a * np.log(r + (1.0 - r) * np.exp(-rest * x / a))


def fitted_slope(t, x, friction, r, *, rested=0.0, x_error=0.0, state_error=0.0):
    """Fit a `Slope` to friction (n,) at times t and displacements x [m], and estimate its noise.

    The result is None if k is not > 0, or if the search does not converge.

    r : V/V_lp at x = 0; ignored after a hold
    rested : displacement that the load point would have made in the hold before [m]; 0 if no hold
    x_error : standard error of x at which loading begins [m]
    state_error : standard error of ln k due to the change of state
    """
    scale = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0]) / (1.0 - r)
    noise = Noise(float(np.ptp(friction)))
    if not (scale > 0.0 and noise.white > 0.0):
        return None

    def creep(p):
        """Return r, and healing [1/m]."""
        if not rested:
            return r, 0.0
        k = np.exp(p[1])
        healing = min(HEALING / rested * np.exp(p[4]), MOST_HEALING * k)
        return np.clip(p[5] * scale / k, *CREEP), healing

    def model(p, x=x):
        at, (k, a) = x - x_error * p[3], np.exp(p[1:3])
        loading = curve(at, p[0], k, a, *creep(p))
        if not rested:
            return loading
        u = np.log1p(np.minimum(at, 0.0) / rested)
        return loading - rested * scale * u * (p[5] + p[6] * u)

    def residuals(p):
        """Return the whitened residuals, and the residuals of the assumptions."""
        return np.append(noise.whiten(t, friction - model(p))[0], weights * (p - first))

    # assumed p, and inverse standard deviations; these hold coordinates that have no effect
    free = 0.0 if rested else 1.0
    level = friction[max(int(np.searchsorted(x, 0.0)) - 1, 0)]
    first = np.array([level, np.log(scale) + 0.1, np.log(A), 0.0, 0.0, 0.01, 0.0])
    weights = np.array([0.0, 0.0, 1.0 / LOG_ERROR, 1.0, 1.0 / LOG_ERROR, free, free])
    bounds, point = (first - MAX_STEP, first + MAX_STEP), first
    for _ in range(ROUNDS):
        fit = scipy.optimize.least_squares(
            residuals, point, bounds=bounds, x_scale="jac", max_nfev=EVALUATIONS
        )
        if not fit.success:
            return None
        point = fit.x
        columns = central_differences(model, point, np.full(point.size, STEP))
        residual = friction - model(point)
        noise, _ = estimated_noise(RestrictedLikelihood(t, residual, columns))
    white, _ = noise.whiten(t, columns)
    covariance = np.linalg.inv(white.T @ white + np.diag(weights**2))
    # (change of ln k if the assumed a and healing change by their standard deviations)
    assumed_error = float(np.hypot(*covariance[1, [2, 4]])) / LOG_ERROR
    u, even = np.maximum(x, 0.0) / x[-1], np.linspace(0.0, x[-1], 100)
    with_cubic = np.column_stack([columns[:, columns.any(axis=0)], u**2, u**3])
    return Slope(
        point,
        independent_error=float(np.sqrt(covariance[1, 1] - assumed_error**2)),
        shared_error=float(np.hypot(assumed_error, state_error)),
        misfit=fall_of_chi2(t, residual, with_cubic, 2, noise),
        r=float(creep(point)[0]),
        straight=float(np.polyfit(even, model(point, even), 1)[0]),
        fitted=model(point),
    )


def slopes_of(t, friction, segments, drops):
    """Return the `Slope`s (list) of a record (m,) with these `Segments`.

    drops : for each segment, starts and ends [s] of its stress drops (m, 2)
    """
    slopes = []
    spans = zip(segments.t, segments.ends, segments.V, drops, strict=True)
    for i, (start, end, V, times) in enumerate(spans):
        rows = np.arange(*np.searchsorted(t, (start, end)))[1:]
        if V == 0.0 or rows.size < FEWEST:
            continue
        if len(times) > 1:
            phases = zip(times[:-1, 1], times[1:, 0], strict=True)
            slopes += [_slope_between_drops(t, friction, *phase, V) for phase in phases]
        elif i:
            slopes.append(_slope_after_change(t, friction, rows, segments, i))
    return [slope for slope in slopes if slope is not None]


def _slope_after_change(t, friction, rows, segments, i):
    start, V, last_V = float(segments.t[i]), segments.V[i], segments.V[i - 1]
    before = _rows_before(t, segments, i)
    if before.size < FEWEST_BEFORE:
        return None
    kind = "reload" if last_V == 0.0 else "step_down" if last_V > V else "step_up"
    rested, level = 0.0, friction[before].mean()
    if kind == "reload":
        rested = V * (start - float(segments.t[i - 1]))
        level = np.polyfit(np.log1p(V * (t[before] - start) / rested), friction[before], 2)[-1]
    rise = (friction[rows] - level) * (-1.0 if kind == "step_down" else 1.0)
    smooth = scipy.ndimage.uniform_filter1d(rise, 3)
    extreme = int(np.argmax(smooth))
    last = _index_at_level(t[rows] - start, rise, smooth[: extreme + 1], UNTIL * smooth[extreme])
    if last < FEWEST or smooth[extreme] < LEAST * sample_noise(friction[rows]):
        return None
    rows = np.concatenate([before, rows[:last]])
    distance = segments.displacement(t[rows]) - segments.displacement(start)
    x = np.where(t[rows] < start, V * (t[rows] - start), distance)
    errors = {"x_error": V * segments.t_error[i], "state_error": STATE_ERROR[kind]}
    slope = fitted_slope(t[rows], x, friction[rows], last_V / V, rested=rested, **errors)
    return slope and slope._replace(kind=kind, start=start, rows=rows)


def _rows_before(t, segments, i):
    """Return the rows before segment i that give the level of friction.

    They are the last part of a slide, or the relaxation in a hold, thinned if it has many rows.
    """
    begin, start = segments.t[i - 1 : i + 1]
    final = np.arange(*np.searchsorted(t, (start - HOLD_PART * (start - begin), start)))
    if segments.V[i - 1] == 0.0:
        before = final[:-MOST_BEFORE]
        return np.append(before[:: before.size // MOST_EARLY + 1], final[-MOST_BEFORE:])
    last = int(np.count_nonzero(t[final] >= start - LEVEL_PART * (start - begin)))
    return final[-min(max(last, FEWEST_BEFORE), MOST_BEFORE) :]


def _index_at_level(t, rise, smooth, level):
    """Return the index at which the line from t = 0 through a rise reaches a level, or 0.

    The first noisy value above the level would come too early.
    """
    above = np.flatnonzero(smooth > level)
    first = int(above[0]) + 1 if above.size else 0
    slope = float(t[:first] @ rise[:first])
    return int(np.searchsorted(t, level * float(t[:first] @ t[:first]) / slope)) if slope > 0 else 0


def _slope_between_drops(t, friction, begin, end, V):
    rows = np.arange(*np.searchsorted(t, [begin + part * (end - begin) for part in STICK]))
    if rows.size < FEWEST_BETWEEN:
        return None
    start = float(t[rows[0]])
    slope = fitted_slope(t[rows], V * (t[rows] - start), friction[rows], 0.0)
    return slope and slope._replace(kind="stick", start=start, rows=rows)
