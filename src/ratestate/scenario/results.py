"""From a result back to the scenario that made it."""

import inspect
import json
from typing import Any

import numpy as np
import xarray

from ..dataset import parameter
from ..errors import ParameterError
from ..loading import Loading
from ..slider import SpringSlider
from ..units import is_array
from .model import VERBS, Scenario

WANTED = "give a Dataset as a verb of ratestate returned it, or read from the file it was kept in"


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
    if verb not in VERBS or not title.startswith("ratestate "):
        raise ParameterError(f"the result's title is {title[:60]!r}, which is no verb's; {WANTED}")
    try:
        slider = SpringSlider(**_slider(result))
        settings = _of_verb[verb](result)
    except ParameterError:
        raise
    except (KeyError, ValueError, TypeError) as error:
        raise ParameterError(
            f"what made this {verb} is not all there ({type(error).__name__}: {error}); {WANTED}"
        ) from None
    return Scenario(verb, slider, _lean(verb, settings))


def _slider(result: Any) -> dict[str, Any]:
    """The slider's parameters."""
    values = json.loads(result.attrs["slider"])
    followed = result.attrs.get("parameter")
    return {k: v if k == followed else _swept(result, k, v) for k, v in values.items()}


def _swept(result: Any, symbol: str, recorded: Any) -> Any:
    """A value that the result records; of a swept one those that the result still holds."""
    if not isinstance(recorded, dict):
        return recorded
    if symbol in result.coords and symbol not in ("V_start", "t_end"):
        return _alone(parameter(result, symbol))
    if not isinstance(recorded["values"], list):  # too many for an attribute
        return _alone(result[symbol])
    return _labelled(result, recorded["dims"], recorded["values"])


def _alone(value: Any) -> Any:
    """A value out of a result, without the labels of cases that it does not depend on."""
    if not is_array(value):
        return value
    return value.drop_vars([name for name, label in value.coords.items() if not label.dims])


def _labelled(result: Any, dims: Any, values: Any) -> Any:
    """An array in some of the result's dimensions, with its labels."""
    for dim, size in zip(dims, np.shape(values), strict=True):
        if dim != "segment" and result.sizes.get(dim) != size:
            raise ParameterError(
                f"the result holds {result.sizes.get(dim, 1)} of {size} cases along {dim!r}, and "
                f"does not say which; give all of them"
            )
    coords = {
        name: c.variable
        for name, c in result.coords.items()
        if set(c.dims) <= set(dims) and c.dims and name != "time"
    }
    return xarray.DataArray(np.asarray(values, float), coords, dims)


def _simulate(result: Any) -> dict[str, Any]:
    """The arguments of `simulate`."""
    attrs = result.attrs
    settings: dict[str, Any] = {"loading": _loading(result)}
    for key in ("t_end", "V_start"):
        settings[key] = _swept(result, key, json.loads(attrs[key]))
    if _same(settings["loading"].V_first, settings["V_start"]):
        del settings["V_start"]
    initial = json.loads(attrs["initial"])
    settings["initial"] = {
        k: _labelled(result, v["dims"], v["values"]) if isinstance(v, dict) else v
        for k, v in initial.items()
    }
    if "times" in attrs:
        own = "t" in result.coords and "time" in result.coords["t"].dims
        settings["times"] = result.coords["t"].drop_vars("t") if own else result["time"].values
    settings["rtol"] = float(attrs["rtol"])
    settings["method"] = str(attrs["method"])
    settings["dt"] = float(attrs["dt"]) if "dt" in attrs else None
    return settings


def _loading(result: Any) -> Loading:
    """The load-point history that a result records."""
    record = json.loads(result.attrs["loading"])
    t_last = np.inf if record["t_last"] is None else float(record["t_last"])
    if "sinusoid" in record:
        values = {
            k: _labelled(result, v["dims"], v["values"]) if isinstance(v, dict) else v
            for k, v in record["sinusoid"].items()
        }
        return Loading.sinusoid(**values, t_end=t_last)
    columns = []
    for name in ("t", "V", "rate"):
        value: Any = record[name] if name in record else result[f"loading_{name}"].variable
        if isinstance(value, dict):
            columns.append(_labelled(result, value["dims"], value["values"]))
        elif isinstance(value, list):
            columns.append(np.array(value, float))
        elif value.ndim == 1:
            columns.append(value.values.astype(float))
        else:
            columns.append(_labelled(result, value.dims, value.values))
    t, V, rate = columns
    return Loading(t, V, rate, t_last)


def _same(x: Any, y: Any) -> bool:
    """Whether two values, floats or DataArrays, are equal."""
    if is_array(x) or is_array(y):
        return is_array(x) and is_array(y) and bool(x.equals(y))
    return bool(x == y)


def _of_speed(result: Any) -> dict[str, Any]:
    """The arguments of `limit_cycle` and `stability`."""
    settings = {"V_lp": _swept(result, "V_lp", json.loads(result.attrs["V_lp"]))}
    if "rtol" in result.attrs:
        settings["rtol"] = float(result.attrs["rtol"])
    return settings


def _branch(result: Any) -> dict[str, Any]:
    """The arguments of `continue_cycle`."""
    attrs = result.attrs
    settings = {key: float(attrs[key]) for key in ("start", "stop", "rtol")}
    V_lp = float(json.loads(attrs["V_lp"])) if "V_lp" in attrs else None
    return {"parameter": str(attrs["parameter"]), **settings, "V_lp": V_lp}


_of_verb = {
    "simulate": _simulate,
    "limit_cycle": _of_speed,
    "stability": _of_speed,
    "continue_cycle": _branch,
}


def _lean(verb: str, settings: dict[str, Any]) -> dict[str, Any]:
    """Settings without those that the verb chooses by itself."""
    defaults = {k: p.default for k, p in inspect.signature(VERBS[verb]).parameters.items()}
    return {
        key: value
        for key, value in settings.items()
        if is_array(value)
        or isinstance(value, np.ndarray)
        or not (value is None or value == {} or value == defaults[key])
    }
