"""What a loading does, as tables for the engine: speed and normal stress on one grid of times."""

import numpy as np
import xarray

from ...engine.model import Loads
from ...model.arrays import as_column
from ...model.units import is_array


def engine_loads(batch, loading):
    """`Loads` of a loading, and the row of each case in its tables, (n,).

    batch : with the slider's sigma
    """
    if (stress := loading.normal_stress) is None:
        table, rows = batch.rows(loading.V)
        return Loads(loading.t, table, batch.rows(loading.rate)[0]), rows
    t = np.union1d(loading.t, stress.t)
    known = stress.with_sigma(batch.values["sigma"])
    columns = _together(*_speeds_at(loading, t), *_stresses_at(known, t))
    (V, rows), *others = (batch.rows(column) for column in columns)
    return Loads(t, V, *(table for table, _ in others)), rows


def comes_to_rest(loads, rows, t_end):
    """(n,) whether the load point rests at any time before t_end, (n,) [s].

    loads, rows : `Loads`, and the row of each case in its tables
    """
    ends, V, rate = np.append(loads.t[1:], np.inf), loads.V, loads.rate
    slows = rate < 0.0
    stop = (loads.t - V / np.where(slows, rate, 1.0)) * (1.0 - 1e-15)  # (rounding)
    rest = np.where(slows & (stop < ends), stop, np.inf)
    return np.where(V > 0.0, rest, loads.t).min(axis=1)[rows] < t_end


def _speeds_at(loading, t):
    """Speed and acceleration in the segments that begin at t."""
    k = loading.speed.segments_at(t)
    V, rate = loading.V[..., k], loading.rate[..., k]
    return np.maximum(V + rate * (t - loading.t[k]), 0.0), rate


def _stresses_at(stress, t):
    """Normal stress, but for its sinusoid, at both ends of the segments that begin at t."""
    k = stress.segments_at(t)
    start, end = stress.start[..., k], stress.end[..., k]
    ends = t, np.append(t[1:], t[-1])  # (in the last segment it is constant)
    return (start + (x - stress.t[k]) / stress.durations[k] * (end - start) for x in ends)


def _together(*columns):
    """Columns of all segments, ``segment`` last, in the same dimensions, if any has others."""
    if not any(map(is_array, columns)):
        return columns
    arrays = (as_column(column).drop_vars("segment", errors="ignore") for column in columns)
    return [array.transpose(..., "segment") for array in xarray.broadcast(*arrays)]
