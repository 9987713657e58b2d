"""Where a record loads or unloads its spring, and the curve of friction that is fitted there.

Quasi-static friction whose state stays as it is, mu = mu_1 + a ln(V/V_1), under dtau/dt =
K (V_lp - V) follows the load point's displacement x as

    mu(x) = mu_0 - a ln(r + (1 - r) exp(-k x/a)),   k = K/sigma,

with r = V/V_lp at x = 0, where mu = mu_0, the level before.  The slope there is k (1 - r): less
than k, for the fault creeps.  r is that of steady sliding at the speed before a step; at the end of
a hold V follows from the relaxation, dmu/dt = -k V; and with r = 0 this is a straight line.  The
relaxation is a quadratic in the logarithm of time: by a straight line V at the end would be a mean
over the times that are fitted, which is a few per cent too large.

A fault that has rested heals on while the spring loads: friction rises by h for each length of x,
so that the fault creeps less.  Then mu - h x follows the same curve, with k - h for k, and r k/(k -
h) for r.  As friction heals with the logarithm of time, h is its rate per e-fold divided by how far
the load point would have moved during the hold.

Of a and the rate of healing, whose effects are hardly seen, it is assumed that they are typical of
rocks and gouges, to a factor of about two: a is 0.008, and friction heals by 0.008 per decade
(Marone 1998 doi:10.1146/annurev.earth.26.1.643).

The coordinates p of a curve are mu_0, ln k, ln a, x_0 (where loading begins, from where it is said
to, in standard errors of that), ln of healing divided by what is assumed, and after a hold the
creep and the bend of its relaxation.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import least_squares

from ..kit.estimated_noise import estimated_noise
from ..kit.noise import Noise
from ..kit.regression import central_differences, fall_of_chi2
from ..kit.sample_noise import sample_noise

#: chi-square of two more coefficients, a quadratic and a cubic one, that 1 of 1000 fits exceed
SIGNIFICANT = 13.82
#: what is assumed of a and of healing per e-fold of time; standard deviation of their logarithms
A, HEALING, LOG_ERROR = 0.008, 0.0035, 0.6
#: largest part of k that healing is; smallest and largest r after a hold
MOST_HEALING, CREEP = 0.5, (1e-12, 0.9)
#: how far p may be from where the search starts: ln k by a factor of 7, others by 8 deviations
REACH = np.array([np.inf, 2.0, 8.0 * LOG_ERROR, 8.0, 8.0 * LOG_ERROR, np.inf, np.inf])
#: rounds of noise and fit; most evaluations; step of a difference
ROUNDS, EVALUATIONS, STEP = 3, 100, 1e-5
#: part of the change of friction up to the extremum over which a curve is fitted; of the time
#: between two stress drops, from and to which
UNTIL, STICK = 0.6, (0.2, 0.6)
#: fewest samples of a slope, before it, and between stress drops; least change of friction, as a
#: multiple of its noise
FEWEST, FEWEST_BEFORE, FEWEST_STUCK, LEAST = 4, 4, 12, 8.0
#: part of the segment before from which friction's level is, with its noise, and most samples of it
BEFORE, MOST_BEFORE = 0.1, 500
#: part of a hold to which its relaxation is fitted, and most samples of it before the last ones
LATE, MOST_EARLY = 0.5, 1000
#: standard error of ln K by the state's change during loading: of the size of the deviations of
#: noiseless slopes under both laws, at k Dc from 1e-3 to 0.1; these go up to 5e-4 after holds, but
#: for what healing does, 6e-3 after steps up by a factor of 3 and 10, and 3e-2 after steps down by
#: a factor of 3
STATE_ERROR = {"reload": 5e-4, "step_up": 4e-3, "step_down": 2e-2}


class Slope(NamedTuple):
    """A loading or unloading of the spring, and the curve fitted to it."""

    point: np.ndarray  # (7,) coordinates
    own_error: float  # of ln k, by all that differs from slope to slope
    shared_error: float  # by what all slopes share: a, healing, and slip's effect on the state
    misfit: float  # fall of chi-square by a quadratic and a cubic beside the curve
    r: float  # V/V_lp where loading begins
    straight: float  # slope of the best straight line through the curve [1/m]
    fitted: np.ndarray  # friction of the rows
    kind: str = ""
    start: float = np.nan  # [s], where x = 0
    rows: np.ndarray | None = None  # with those before

    @property
    def k(self):
        """K divided by the normal stress [1/m]."""
        return float(np.exp(self.point[1]))

    @property
    def k_error(self):
        """Its standard error."""
        return self.k * float(np.hypot(self.own_error, self.shared_error))

    @property
    def fits(self):
        """Whether the curve explains the samples."""
        return self.misfit < SIGNIFICANT


def curve(x, mu_0, k, a, r, healing=0.0):
    """The equation above; mu_0 where x < 0."""
    x = np.maximum(x, 0.0)
    if r == 0.0:
        return mu_0 + k * x
    rest = k - healing
    r = r * k / rest
    return mu_0 + healing * x - a * np.log(r + (1.0 - r) * np.exp(-rest * x / a))


def fitted_slope(t, x, friction, r, *, rested=0.0, x_error=0.0, state_error=0.0):
    """`Slope` of friction (n,) at times t and displacements x [m], with noise as its residuals are.

    None if k is not > 0, and if the search does not converge.

    r : V/V_lp at x = 0, unless `rested` is not 0
    rested : how far the load point would have moved during the hold before [m]; 0 without one
    x_error : standard error of where loading begins [m]
    state_error : standard error of ln k by what slip does to the state
    """
    scale = float(np.polyfit(x[x >= 0.0], friction[x >= 0.0], 1)[0]) / (1.0 - r)
    noise = Noise(float(np.ptp(friction)))
    if not (scale > 0.0 and noise.white > 0.0):
        return None

    def creep(p):
        """r, and healing [1/m]."""
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
        """Residuals, whitened, and those of what is assumed."""
        return np.append(noise.whiten(t, friction - model(p))[0], weights * (p - first))

    # what is assumed of p, and the inverse of its standard deviation; what has no effect is held
    free = 0.0 if rested else 1.0
    level = friction[max(int(np.searchsorted(x, 0.0)) - 1, 0)]
    first = np.array([level, np.log(scale) + 0.1, np.log(A), 0.0, 0.0, 0.01, 0.0])
    weights = np.array([0.0, 0.0, 1.0 / LOG_ERROR, 1.0, 1.0 / LOG_ERROR, free, free])
    bounds, point = (first - REACH, first + REACH), first
    for _ in range(ROUNDS):
        found = least_squares(residuals, point, bounds=bounds, x_scale="jac", max_nfev=EVALUATIONS)
        if not found.success:
            return None
        point = found.x
        columns = central_differences(model, point, np.full(point.size, STEP))
        residual = friction - model(point)
        noise = estimated_noise(t, residual, columns)
    white, _ = noise.whiten(t, columns)
    covariance = np.linalg.inv(white.T @ white + np.diag(weights**2))
    # (by what ln k moves where what is assumed does by its standard deviation)
    assumed = float(np.hypot(*covariance[1, [2, 4]])) / LOG_ERROR
    u, even = np.maximum(x, 0.0) / x[-1], np.linspace(0.0, x[-1], 100)
    seen = np.column_stack([columns[:, columns.any(axis=0)], u**2, u**3])
    return Slope(
        point,
        own_error=float(np.sqrt(covariance[1, 1] - assumed**2)),
        shared_error=float(np.hypot(assumed, state_error)),
        misfit=fall_of_chi2(t, residual, seen, 2, noise),
        r=float(creep(point)[0]),
        straight=float(np.polyfit(even, model(point, even), 1)[0]),
        fitted=model(point),
    )


def slopes_of(t, friction, segments, drops):
    """list of `Slope`s of a record (m,) with these `Segments`.

    drops : for each segment starts and ends [s] of the stress drops in it (m, 2)
    """
    found = []
    spans = zip(segments.t, segments.ends, segments.V, drops, strict=True)
    for i, (start, end, V, own) in enumerate(spans):
        rows = np.arange(*np.searchsorted(t, (start, end)))[1:]
        if V == 0.0 or rows.size < FEWEST:
            continue
        if len(own) > 1:
            phases = zip(own[:-1, 1], own[1:, 0], strict=True)
            found += [_stuck(t, friction, *phase, V) for phase in phases]
        elif i:
            found.append(_after_change(t, friction, rows, segments, i))
    return [one for one in found if one is not None]


def _after_change(t, friction, rows, segments, i):
    """The `Slope` after a hold or a step, or None."""
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
    smooth = uniform_filter1d(rise, 3)
    extreme = int(np.argmax(smooth))
    last = _reaches(t[rows] - start, rise, smooth[: extreme + 1], UNTIL * smooth[extreme])
    if last < FEWEST or smooth[extreme] < LEAST * sample_noise(friction[rows]):
        return None
    rows = np.concatenate([before, rows[:last]])
    moved = segments.displacement(t[rows]) - segments.displacement(start)
    x = np.where(t[rows] < start, V * (t[rows] - start), moved)
    errors = {"x_error": V * segments.t_error[i], "state_error": STATE_ERROR[kind]}
    slope = fitted_slope(t[rows], x, friction[rows], last_V / V, rested=rested, **errors)
    return slope and slope._replace(kind=kind, start=start, rows=rows)


def _rows_before(t, segments, i):
    """Rows before segment i from which friction's level is.

    After sliding the last part; in a hold its relaxation too, of which most rows are left out where
    they are many.
    """
    begin, start = segments.t[i - 1 : i + 1]
    late = np.arange(*np.searchsorted(t, (start - LATE * (start - begin), start)))
    if segments.V[i - 1] == 0.0:
        early = late[:-MOST_BEFORE]
        return np.append(early[:: early.size // MOST_EARLY + 1], late[-MOST_BEFORE:])
    last = int(np.count_nonzero(t[late] >= start - BEFORE * (start - begin)))
    return late[-min(max(last, FEWEST_BEFORE), MOST_BEFORE) :]


def _reaches(t, rise, smooth, level):
    """Index at which the line from t = 0 through a rise that reaches a level does so; 0 for none.

    (The first noisy value above it would come too soon.)
    """
    above = np.flatnonzero(smooth > level)
    first = int(above[0]) + 1 if above.size else 0
    slope = float(t[:first] @ rise[:first])
    return int(np.searchsorted(t, level * float(t[:first] @ t[:first]) / slope)) if slope > 0 else 0


def _stuck(t, friction, begin, end, V):
    """The `Slope` in a loading phase between stress drops, from begin to end [s], or None."""
    rows = np.arange(*np.searchsorted(t, [begin + part * (end - begin) for part in STICK]))
    if rows.size < FEWEST_STUCK:
        return None
    start = float(t[rows[0]])
    slope = fitted_slope(t[rows], V * (t[rows] - start), friction[rows], 0.0)
    return slope and slope._replace(kind="stick", start=start, rows=rows)
