"""The speeds at which steady sliding changes stability, under any friction law.

The functions take NumPy arrays of one shape in SI units, by their symbols, and check no ranges.
"""

from typing import NamedTuple

import numpy as np

from . import closed_forms
from .linear_stability import edges, stability_margin
from .roots import root_between

# Speeds [m/s] between which V_c is searched for if the law has a speed scale, points per decade.
# (If weakening fades as 1/V, rounding would decide at even larger speeds.)
SLOWEST, FASTEST, PER_DECADE = 1e-40, 1e9, 10
# Number of grids, and of their points, that give the least stable speed to 1e-8 relative.
GRIDS, POINTS = 6, 33
# Sliders in one search, to limit memory.
BATCH = 1000


class CriticalSpeeds(NamedTuple):
    """Speeds [m/s] at which steady sliding changes stability."""

    V_c: np.ndarray  # above this speed sliding is unstable; the lowest such speed
    V_c_upper: np.ndarray  # the next speed from which it is stable again


def V_c(law, *, K, **values):
    """Return the `CriticalSpeeds` of sliders.

    V_c is 0 if sliding is unstable down to rest, and inf if it is stable at any speed.  V_c_upper
    is inf if sliding stays unstable.  Under a law with a speed scale it may become unstable again
    at larger speeds.
    """
    if law.one_length:
        lower = closed_forms.V_c(K=K, **values)
        return CriticalSpeeds(lower, np.full(np.shape(lower), np.inf))
    if not law.has_speed_scale:
        return CriticalSpeeds(*_speeds_by_edges(law, K=K, **values))
    columns = {name: np.reshape(value, (-1, 1)) for name, value in {"K": K, **values}.items()}
    speeds = [
        _speeds_by_search(law, **{name: x[i : i + BATCH] for name, x in columns.items()})
        for i in range(0, np.size(K), BATCH)
    ]
    return CriticalSpeeds(*np.concatenate(speeds, axis=1).reshape(2, *np.shape(K)))


def _speeds_by_edges(law, *, sigma, K, M, **values):
    """Return V_c and V_c_upper, if z and the quasi-static part of edges are constant."""
    p = law.coefficient_arrays(np.ones(np.shape(K)), {"sigma": sigma, **values})
    z, per_z, pairs_at_edge = edges(law, p)
    unit = values["a"] * sigma / values["Dc"]
    excess = K[..., None] - z * per_z * unit[..., None]
    rounding = closed_forms.ROUNDING * np.abs(K)[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = np.sqrt(excess / (z * (M / values["Dc"] ** 2)[..., None]))
    speed = np.where(excess > rounding, speed, 0.0)
    speed = np.where((pairs_at_edge == 0) | np.isinf(K)[..., None], np.inf, speed)
    # number of unstable pairs just above each of these speeds
    is_passed = speed[..., None, :] <= speed[..., None]
    pairs = (pairs_at_edge[..., None, :] * is_passed).sum(axis=-1)
    lower = np.where(pairs > 0, speed, np.inf).min(axis=-1)
    later = (pairs <= 0) & (speed > lower[..., None])
    return lower, np.where(later, speed, np.inf).min(axis=-1)


def _speeds_by_search(law, *, K, **values):
    """Return V_c and V_c_upper, (n,) each, from a search between speeds of a grid.

    If no speed of the grid is unstable, a speed near the least stable one of them may be.

    K, values : (n, 1)
    """

    def margin(v):
        return stability_margin(law, np.exp(v), K=K, **values)

    n_decades = round(np.log10(FASTEST / SLOWEST))
    grid = np.log(np.geomspace(SLOWEST, FASTEST, n_decades * PER_DECADE + 1))
    on_grid = margin(grid[None])
    unstable = on_grid <= 0.0
    has_unstable, first = unstable.any(axis=1), unstable.argmax(axis=1)
    after = unstable | (np.arange(grid.size) < first[:, None])
    last = after.argmin(axis=1)  # the first stable speed after `first`, 0 if there is none
    inside = grid[np.stack([np.maximum(first - 1, 0), last], axis=1)]
    outer = grid[np.stack([first, np.maximum(last - 1, 0)], axis=1)]
    if not has_unstable.all():
        least = np.clip(on_grid.argmin(axis=1), 1, grid.size - 2)
        neighbours = grid[np.stack([least - 1, least + 1], axis=1)]
        low, high = neighbours.T[..., None]
        inside = np.where(has_unstable[:, None], inside, neighbours)
        outer = np.where(has_unstable[:, None], outer, _minimiser(margin, low, high))
    lower, upper = np.exp(root_between(margin, inside, outer)).T
    lower = np.where(np.isnan(lower), np.inf, lower)
    upper = np.where(np.isnan(upper) | (has_unstable & (last == 0)), np.inf, upper)
    return np.where(unstable[:, 0], 0.0, lower), upper


def _minimiser(function, low, high):
    """Return the minimiser (n, 1) between numbers (n, 1), by ever finer grids."""
    for _ in range(GRIDS):
        grid = low + (high - low) * np.linspace(0.0, 1.0, POINTS)
        least = function(grid).argmin(axis=1)[:, None]
        neighbours = np.clip(least + np.array([-1, 1]), 0, POINTS - 1)
        low, high = np.take_along_axis(grid, neighbours, axis=1).T[..., None]
    return np.take_along_axis(grid, least, 1)
