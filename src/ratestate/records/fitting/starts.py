"""Starting points of a search, from sizes that the record suggests, and its bounds.

The friction of a velocity step fixes the sizes of all parameters to an order of magnitude or two.
Within those a seeded cloud of sliders is marched at once; the least squares start from the best of
them and the user's own.
"""

import numpy as np

from .unknowns import START, Unknowns, to_coordinate

#: sliders in the cloud, and the samples of the record that they are compared with
CLOUD, SAMPLES = 96, 500
SEED = 20190101
#: ln of the ratio of speeds that a hold counts as
HOLD = 5.0
#: least distance of two starts in some coordinate, ln 2
DISTANCE = 0.7
#: how far the cloud reaches from the sizes of `_sizes`, in powers of ten
DECADES = {"a": (-0.5, 0.5), "Dc": (-1.5, 0.7), "K": (-0.5, 1.5), "M": (-3.0, 1.0)}


def unknowns_of(record, free, *, start, sigma):
    """`Unknowns` of a record: free parameters, the start if that is free, level, trend."""
    sizes = _sizes(record, sigma)
    edges = {
        "a": (1e-3, 1e2),
        "b": (-1e2, 1e2),
        "Dc": (1e-3, 1e3),
        "K": (1e-4, 1e6),
        "M": (1e-8, 1e4),
    }
    names = (*free, *(START if start else ()), "level", *(("trend",) if record.trend else ()))
    low, high = [], []
    for name in names:
        if name in edges:
            ends = [edge * sizes[name] for edge in edges[name]]
            ends = ends if name == "b" else list(np.log(ends))
        elif name in START:
            ends = [-20.0, 20.0]
        elif name == "lag":
            ends = [-0.1 * record.t[-1], 0.1 * record.t[-1]]
        else:
            ends = [-np.inf, np.inf]
        low.append(ends[0])
        high.append(ends[1])
    return Unknowns(names, np.array(low), np.array(high))


def starting_points(problem, slider):
    """Points (k,) to start from, all distinct, the best fit to a thinned record first."""
    unknowns, record = problem.unknowns, problem.record
    sizes = _sizes(record, slider.sigma)
    rng = np.random.default_rng(SEED)
    cloud = np.zeros((CLOUD + 1, len(unknowns.names)))
    for i, name in enumerate(unknowns.names):
        if name == "b":
            cloud[:, i] = sizes["b"] * rng.uniform(-1.0, 3.0, CLOUD + 1)
        elif name in sizes:
            exponent = rng.uniform(*DECADES[name], CLOUD + 1)
            cloud[:, i] = np.log(sizes[name] * 10.0**exponent)
        if name in sizes:
            cloud[0, i] = to_coordinate(name, getattr(slider, name))
    cloud = np.clip(cloud, unknowns.low, unknowns.high)
    sized = [i for i, name in enumerate(unknowns.names) if name in sizes]
    cloud, misfit = problem.with_best_level(cloud if sized else cloud[:1])
    order = np.argsort(misfit, kind="stable")
    # distances in b, the only one that is no logarithm, are over its size
    scale = np.array([sizes["b"] if name == "b" else 1.0 for name in unknowns.names])
    points: list = []
    for point in cloud[order[: int(np.isfinite(misfit).sum())]]:
        if all((np.abs(point - other) / scale)[sized].max() > DISTANCE for other in points):
            points.append(point)
    return points


def _sizes(record, sigma):
    """symbol -> order of magnitude that the record suggests [SI]."""
    speeds = record.loading.V[record.loading.V > 0.0]
    ratio = max(float(np.abs(np.log(speeds / record.loading.V[0])).max()), 1.0)
    if speeds.size < record.loading.V.size:  # in a hold the slider slows by orders of magnitude
        ratio = max(ratio, HOLD)
    scale = record.scale / ratio
    t, slow = record.t, float(speeds.min())
    distance = float(record.loading.delta_lp(t[-1:])[0] - record.loading.delta_lp(t[:1])[0])
    distance = max(distance, 10.0 * slow * record.spacing)
    K = 10.0 * sigma * record.scale / distance
    return {"a": scale, "b": scale, "Dc": 0.05 * distance, "K": K, "M": K * (t[-1] / 50.0) ** 2}
