"""The load-point history that a result records, checked: it may have been altered."""

import dataclasses
from typing import Any

import numpy as np
import xarray

from ...dynamics import attributes
from ...errors import ParameterError
from ...model.history import NormalStress
from ...model.loading import Loading
from .recorded_values import WANTED, values_of, with_labels

#: how far a speed at the end of a segment may fall below 0, relative to the largest speed
ROUNDING = 1e-9


def recorded_loading(result: Any) -> Loading:
    """The load-point history that a result records, and that of normal stress."""
    record = attributes.loading_record(result)
    loading = _speeds(result, record)
    if "sigma" not in record:
        return loading
    return dataclasses.replace(loading, normal_stress=_normal_stress(result, record["sigma"]))


def _speeds(result: Any, record: dict[str, Any]) -> Loading:
    """The history of speeds that a result records."""
    t_last = np.inf if record["t_last"] is None else float(record["t_last"])
    if "sinusoid" in record:
        return Loading.sinusoid(**values_of(result, "loading", record["sinusoid"]), t_end=t_last)
    t, V, rate = (
        _column(result, record, name, "loading_", "segment") for name in ("t", "V", "rate")
    )
    if not _is_history(t, np.asarray(V), np.asarray(rate), t_last):
        raise ParameterError(f"the loading that the Dataset records is no history; {WANTED}")
    return Loading(t, V, rate, t_last)


def _normal_stress(result: Any, record: Any) -> NormalStress:
    """The history of normal stress that a result records."""
    wave = {"amplitude": 0.0, "period": np.inf}
    if not isinstance(record, dict):
        raise ParameterError(f"the normal stress that the Dataset records is none; {WANTED}")
    given = {name: x for name, x in record.items() if name in wave}
    names = "t", "start", "end"
    t, start, end = (
        _column(result, record, name, "loading_sigma_", "segment_of_sigma") for name in names
    )
    shapes = {np.shape(start), np.shape(end)}
    sound = t.ndim == 1 and t.size and len(shapes) == 1 and np.shape(start)[-1:] == t.shape
    if not sound or t[0] != 0.0 or not (np.diff(t) > 0.0).all():
        raise ParameterError(f"the normal stress that the Dataset records is none; {WANTED}")
    if not all(
        np.greater(column, 0.0)[np.isfinite(column)].all()
        for column in map(np.asarray, (start, end))
    ):
        raise ParameterError(f"the normal stress that the Dataset records is not > 0; {WANTED}")
    ends_ramp = t.size > 1 and bool(np.any(np.not_equal(start[..., -2], end[..., -2])))
    wave |= values_of(result, "loading", given)
    return NormalStress(t, start, end, **wave, returns=ends_ramp)


def _column(result: Any, record: dict[str, Any], name: str, prefix: str, dim: str) -> Any:
    """A column of a history, from the record or a variable of the result; NaN for null."""
    value: Any = record[name] if name in record else result[prefix + name].variable
    if isinstance(value, dict):
        value = attributes.array("loading", value)
    if np.ndim(value) <= 1:
        return np.array(value, float)
    array = xarray.DataArray(value).astype(float)
    return with_labels(result, array.rename({dim: "segment"} if dim in array.dims else {}))


def _is_history(t: Any, V: Any, rate: Any, t_last: float) -> bool:
    """Whether these can be the fields of a `Loading`: times that increase, speeds >= 0."""
    if not (t.ndim == 1 and t.size and V.shape == rate.shape and V.shape[-1:] == t.shape):
        return False
    lasts = np.diff(t, append=t_last)
    with np.errstate(invalid="ignore", over="ignore"):
        ends = V + np.where(rate == 0.0, 0.0, rate * lasts)
    return bool(
        (t[0] == 0.0 and (lasts > 0.0).all())
        and all(np.isfinite(column).all() for column in (t, V, ends))
        and (V >= 0.0).all()
        and (ends >= -ROUNDING * V.max()).all()
    )
