"""The scenario that made a result, from the attributes of the result."""

import dataclasses
import inspect
from typing import Any

import numpy as np
import xarray

from ...dynamics import attributes
from ...dynamics.results import parameter
from ...errors import ParameterError
from ...model.loading import Loading
from ...model.slider import SpringSlider
from ...model.units import is_array
from .model import FUNCTIONS, Scenario, check

WANTED = "give a Dataset as a verb of ratestate returned it, or read from the file it was kept in"

#: how far a speed at the end of a segment may fall below 0, relative to the largest speed
ROUNDING = 1e-9


def from_result(result: Any) -> Scenario:
    """The scenario that made a result: run again, it gives the same bits.

    Parameters
    ----------
    result : xarray.Dataset
        Of `simulate`, `limit_cycle`, `stability` or `continue_cycle`, or of a sweep of one, as it
        was returned or as it is read from a file.

    Raises
    ------
    ParameterError
        The Dataset has lost attributes or variables that tell how it was made.
    """
    if not isinstance(result, xarray.Dataset):
        raise ParameterError(f"{type(result).__name__} is no result; {WANTED}")
    title = str(result.attrs.get("title", ""))
    verb = title.removeprefix("ratestate ")
    if title == "ratestate fit":
        raise ParameterError(
            "the result is a fit, of which there is no scenario: fit the record again with "
            "ratestate fit, or with the lines of Python in its report.md; to go on with the slider "
            "that it found, take ratestate.fitting.slider_of(result)"
        )
    if verb not in FUNCTIONS or not title.startswith("ratestate "):
        raise ParameterError(f"the result's title is {title[:60]!r}, which is no verb's; {WANTED}")
    try:
        scenario = Scenario(
            verb, _slider(result), _without_defaults(verb, _settings_of[verb](result))
        )
        check(scenario)
    except ParameterError:
        raise
    except Exception as error:  # variables too may be gone, or others than they were
        raise ParameterError(
            f"what made this {verb} is not all there ({type(error).__name__}: {error}); {WANTED}"
        ) from None
    return scenario


def _slider(result: Any) -> SpringSlider:
    """The slider, with the cases that the result still has."""
    values = attributes.from_json(result, "slider", dict)
    symbols = {field.name for field in dataclasses.fields(SpringSlider)}
    if odd := symbols ^ set(values):
        raise ParameterError(
            f"the attribute 'slider' of the Dataset lacks, or has beside what it should, "
            f"{', '.join(sorted(odd))[:100]}; {WANTED}"
        )
    followed = result.attrs.get("parameter")
    swept = {k: _swept(result, "slider", k, v) for k, v in values.items() if k != followed}
    return SpringSlider(**values | swept)


def _swept(result: Any, name: str, symbol: str, recorded: Any) -> Any:
    """The value recorded in an attribute; of a swept one the cases that the result still has."""
    if not isinstance(recorded, dict):
        return attributes.parameter_value(name, symbol, recorded)
    if symbol in result.coords and symbol not in ("V_start", "t_end"):
        return _without_case_labels(parameter(result, symbol))
    if isinstance(recorded.get("values"), str):  # too many for an attribute
        return _without_case_labels(result[symbol])
    return _labelled(result, attributes.array(name, recorded))


def _without_case_labels(value: Any) -> Any:
    """A value of a result, without scalar coordinates."""
    if not is_array(value):
        return value
    return value.drop_vars([name for name, label in value.coords.items() if not label.dims])


def _labelled(result: Any, recorded: Any) -> Any:
    """A recorded array over some of the result's dimensions, with the result's labels."""
    for dim, size in recorded.sizes.items():
        if dim != "segment" and result.sizes.get(dim) != size:
            raise ParameterError(
                f"the result holds {result.sizes.get(dim, 1)} of {size} cases along {dim!r}, and "
                f"does not say which; give all of them"
            )
    coords = {
        name: c.variable
        for name, c in result.coords.items()
        if set(c.dims) <= set(recorded.dims) and c.dims and name != "time"
    }
    return recorded.drop_vars(recorded.coords).assign_coords(coords)


def _values(result: Any, name: str, given: dict[str, Any]) -> dict[str, Any]:
    """The values in an attribute, some of which may be swept."""
    return {
        k: _labelled(result, attributes.array(name, v)) if isinstance(v, dict) else v
        for k, v in given.items()
    }


def _simulate(result: Any) -> dict[str, Any]:
    """The arguments of `simulate`."""
    attrs = result.attrs
    settings: dict[str, Any] = {"loading": _loading(result)}
    for key in ("t_end", "V_start"):
        settings[key] = _swept(result, key, key, attributes.from_json(result, key))
    if _same(settings["loading"].V_first, settings["V_start"]):
        del settings["V_start"]
    settings["initial"] = _values(result, "initial", attributes.from_json(result, "initial", dict))
    if "times" in attrs:
        own = "t" in result.coords and "time" in result.coords["t"].dims
        settings["times"] = result.coords["t"].drop_vars("t") if own else result["time"].values
    settings["rtol"] = attributes.number(result, "rtol")
    settings["method"] = attributes.text(result, "method")
    settings["dt"] = attributes.number(result, "dt") if "dt" in attrs else None
    return settings


def _loading(result: Any) -> Loading:
    """The load-point history that a result records."""
    record = attributes.loading_record(result)
    t_last = np.inf if record["t_last"] is None else float(record["t_last"])
    if "sinusoid" in record:
        return Loading.sinusoid(**_values(result, "loading", record["sinusoid"]), t_end=t_last)
    columns = []
    for name in ("t", "V", "rate"):
        value: Any = record[name] if name in record else result[f"loading_{name}"].variable
        if isinstance(value, dict):
            columns.append(_labelled(result, attributes.array("loading", value)))
        elif isinstance(value, list):
            columns.append(np.array(value, float))
        elif value.ndim == 1:
            columns.append(value.values.astype(float))
        else:
            columns.append(_labelled(result, xarray.DataArray(value.astype(float))))
    t, V, rate = columns
    if not _is_history(t, np.asarray(V), np.asarray(rate), t_last):
        raise ParameterError(f"the loading that the Dataset records is no history; {WANTED}")
    return Loading(t, V, rate, t_last)


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


def _same(x: Any, y: Any) -> bool:
    """Whether two values, floats or DataArrays, are equal."""
    if is_array(x) or is_array(y):
        return is_array(x) and is_array(y) and bool(x.equals(y))
    return bool(x == y)


def _stability(result: Any) -> dict[str, Any]:
    """The arguments of `stability`."""
    return {"V_lp": _swept(result, "V_lp", "V_lp", attributes.from_json(result, "V_lp"))}


def _limit_cycle(result: Any) -> dict[str, Any]:
    """The arguments of `limit_cycle`."""
    return _stability(result) | {"rtol": attributes.number(result, "rtol")}


def _branch(result: Any) -> dict[str, Any]:
    """The arguments of `continue_cycle`."""
    settings: dict[str, Any] = {"parameter": attributes.branch_parameter(result), "V_lp": None}
    settings |= {key: attributes.number(result, key) for key in ("start", "stop", "rtol")}
    if settings["parameter"] != "V_lp":
        recorded = attributes.from_json(result, "V_lp")
        settings["V_lp"] = attributes.parameter_value("V_lp", "V_lp", recorded)
    return settings


_settings_of = {
    "simulate": _simulate,
    "limit_cycle": _limit_cycle,
    "stability": _stability,
    "continue_cycle": _branch,
}


def _without_defaults(verb: str, settings: dict[str, Any]) -> dict[str, Any]:
    """Settings without those equal to the function's defaults."""
    defaults = {k: p.default for k, p in inspect.signature(FUNCTIONS[verb]).parameters.items()}
    return {
        key: value
        for key, value in settings.items()
        if is_array(value)
        or isinstance(value, np.ndarray)
        or not (value is None or value == {} or value == defaults[key])
    }
