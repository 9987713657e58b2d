"""Features of cycles, by which the cycles of a record and of a model are compared.

The phase holds no information on friction, and would give the likelihood many peaks.  So a
record is cut into cycles, these are averaged into one profile, and six features of the profile
are measured.  The period has four parts, between the times at which tau/sigma crosses 1/4 and
3/4 of its range:

    amplitude   peak-to-peak tau/sigma                  period
    rise        from 1/4 to 3/4, the spring loading     high   above 3/4
    drop        from 3/4 to 1/4, slip faster than V_lp  level  mean tau/sigma

The time below 1/4 is the rest of the period.  Six features at one speed are as many as the
parameters a, b, Dc, K, M and mu0 of a cycle.  The curve is steep at the crossings and flat at
the extremes, so that noise moves the crossings little.
"""

import numpy as np

FEATURES = ("amplitude", "period", "rise", "high", "drop", "level")
AMPLITUDE, PERIOD, RISE, HIGH, DROP, LEVEL = range(len(FEATURES))
# Number of phases of a model's profile.
FINE = 1024
# Bisections in the search for an extreme, to 1e-6 of the period.
HALVINGS = 11
# Fractions of the range at which the four parts of the period meet.
UPPER, LOWER = 0.75, 0.25


def profile_features(profiles, period, extremes=None):
    """Return features (n, 6) of profiles (n, m) over one period (n,).

    extremes : (n, 2) smallest and largest values, if known more precisely

    Features are logarithms, except the level.  A profile may begin anywhere, and must have one
    largest and one smallest value.  A part without length has -inf or NaN.
    """
    n, m = profiles.shape
    top = np.argmax(profiles, axis=1)
    # one period, from maximum to maximum
    y = np.take_along_axis(profiles, (top[:, None] + np.arange(m + 1)) % m, axis=1)
    bottom = np.argmin(y, axis=1)
    row = np.arange(n)
    least, most = (y.min(axis=1), y[:, 0]) if extremes is None else extremes.T
    amplitude = most - least
    after = np.arange(m + 1) > bottom[:, None]

    def crossing(part, down):
        level = (least + part * amplitude)[:, None]
        i = np.argmax(y < level if down else (y >= level) & after, axis=1)
        i = np.maximum(i, 1)
        before, behind = y[row, i - 1], y[row, i]
        with np.errstate(divide="ignore", invalid="ignore"):
            return i - 1.0 + (level[:, 0] - before) / (behind - before)

    falls = crossing(UPPER, down=True), crossing(LOWER, down=True)
    rises = crossing(LOWER, down=False), crossing(UPPER, down=False)
    rise, drop = rises[1] - rises[0], falls[1] - falls[0]
    high = m - rises[1] + falls[0]
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = [np.log(part / m * period) for part in (rise, high, drop)]
        columns = [np.log(amplitude), np.log(period), *parts, profiles.mean(axis=1)]
    return np.stack(columns, axis=1)


def wave_profiles(grid, waves, bins):
    """Return profiles (n, FINE) and extremes (n, 2) of waves (n, q).

    grid : (q,) phases of the waves from 0 to 1, between which they are linear

    Values are means of the wave over the width of a bin.  There are more values than bins, so that
    features change smoothly with parameters.
    """
    step = np.diff(grid)
    sums = np.zeros_like(waves)
    np.cumsum(0.5 * step * (waves[:, 1:] + waves[:, :-1]), axis=1, out=sums[:, 1:])
    half = 0.5 / bins
    middles = np.arange(FINE) / FINE
    ends = np.concatenate([middles - half, middles + half])[None]
    before, after = np.split(_integrals(grid, waves, sums, ends), 2, axis=1)
    profiles = (after - before) * bins
    extremes = np.empty((len(waves), 2))
    for side, index in enumerate((np.argmin(profiles, axis=1), np.argmax(profiles, axis=1))):
        at = _extremum(grid, waves, index / FINE, half, 1.0 if side else -1.0)
        ends = np.stack([at - half, at + half], axis=1)
        extremes[:, side] = np.diff(_integrals(grid, waves, sums, ends))[:, 0] * bins
    return profiles, extremes


def _extremum(grid, waves, near, half, sign):
    """Return phases (n,) at which means are largest (sign 1) or smallest (-1).

    There a wave has equal values at both ends of the window.  Bisection finds them: kinks between
    the phases of the profile would mislead a parabola.
    """
    low, high = near - 1.0 / FINE, near + 1.0 / FINE
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        ends = np.stack([middle - half, middle + half], axis=1) % 1.0
        j, left, rate = _pieces(grid, waves, ends)
        value = left + rate * (ends - grid[j])
        before = sign * (value[:, 1] - value[:, 0]) > 0.0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return 0.5 * (low + high)


def _pieces(grid, waves, within):
    """Return indices, values, slopes of a wave's linear pieces at phases (n or 1, e)."""
    j = np.clip(np.searchsorted(grid, within, side="right") - 1, 0, grid.size - 2)
    j = np.broadcast_to(j, (len(waves), j.shape[1]))
    left = np.take_along_axis(waves, j, axis=1)
    return j, left, (np.take_along_axis(waves, j + 1, axis=1) - left) / (grid[j + 1] - grid[j])


def _integrals(grid, waves, sums, ends):
    """Return integrals (n, e) of periodic waves from phase 0 to phases (n or 1, e)."""
    periods, within = np.divmod(ends, 1.0)
    j, left, rate = _pieces(grid, waves, within)
    beyond = within - grid[j]
    before = np.take_along_axis(sums, j, axis=1)
    return periods * sums[:, -1:] + before + beyond * (left + 0.5 * rate * beyond)
