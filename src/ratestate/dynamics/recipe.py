"""Write the call that made a result into its attributes, as a scenario, and read it again.

Anybody can lose or change attributes: functions that read them raise `ParameterError` then.
"""

import functools
import json
from importlib.metadata import version

import numpy as np
import xarray

from ..engine.machine_code import DIGEST
from ..errors import ParameterError
from ..model.conversion import in_si
from ..model.load_point import Call
from ..model.loading import Loading
from ..model.quantities import QUANTITIES
from ..model.units import is_array
from .refusals import refusal

#: longest column in an attribute, which holds 64 KiB in a NetCDF file; longer ones are variables
LONGEST_COLUMN = 1000


@functools.cache
def versions():
    """Return the versions of the programs that compute the numbers, as JSON (it takes 1 ms)."""
    programs = {name: version(name) for name in ("ratestate", "llvmlite", "numpy")}
    return json.dumps(programs | {"kernels": DIGEST})


def record_scenario(result, function, slider, **arguments):
    """Put the call that makes a result again into its attributes, in place.

    The attribute ``scenario`` is JSON: ``function``, the parameters of the slider, and the other
    arguments that are not None, in SI.  A loading is a list of calls,
    [method, {argument: value}], with texts such as "1 mm/s" as given.  An array is
    ``{"variable": name}``: the coordinate that has its values, or a variable that is added.
    """
    given = {name: value for name, value in arguments.items() if value is not None}
    known = {"function": function, "slider": slider.parameters, **given}
    result.attrs |= {
        "title": f"ratestate {function}",
        "scenario": json.dumps({name: _plain(result, name, name, x) for name, x in known.items()}),
        "versions": versions(),
    }


def recorded_result(function, slider, batch, variables, reserved, **arguments):
    """Return variables of all cases as a Dataset with coordinates and scenario.

    batch : `Batch` of the slider's parameters and the arguments
    reserved : names that a coordinate must not have
    """
    result = xarray.Dataset(variables, batch.coordinates(reserved))
    record_scenario(result, function, slider, **arguments)
    return result


def record_loading(result, loading):
    """Put the calls that make a loading into the attribute ``loading`` of a result, in place."""
    result.attrs["loading"] = json.dumps(_plain(result, "loading", "loading", loading))


def _plain(result, name, symbol, value):
    """Return a value for JSON.

    name, symbol : of a variable that may be added, and of the quantity
    """
    if isinstance(value, Loading):
        return [_plain_call(result, f"{name}_{i}", call) for i, call in enumerate(value.calls)]
    if isinstance(value, dict):
        return {key: _plain(result, f"{name}_{key}", key, x) for key, x in value.items()}
    if not is_array(value) and not isinstance(value, np.ndarray):
        return value
    if symbol == "times":
        return {"variable": "t" if is_array(value) else "time"}
    if not is_array(value) and value.size <= LONGEST_COLUMN:
        return value.tolist()
    known = result.coords.get(symbol)
    if is_array(value) and known is not None and known.variable.equals(value.variable):
        return {"variable": symbol}
    dims = value.dims if is_array(value) else ("segment",)
    labels = {"units": QUANTITIES[symbol].unit, "long_name": name.replace("_", " ")}
    result[name] = (dims, np.asarray(value), labels)
    return {"variable": name}


def _plain_call(result, name, call):
    given = call.arguments.items()
    return [call.method, {k: _plain(result, f"{name}_{k}", call.symbol(k), x) for k, x in given}]


def attribute_text(result, name, default=None):
    """Return an attribute that is a text, or the default if it is missing.

    Raises ParameterError if it is missing and has no default, and if it is not a text.
    """
    value = result.attrs.get(name, default)
    if value is None:
        raise refusal("attributes.lost", name=name)
    if not isinstance(value, str):
        raise refusal("attributes.altered", name=name)
    return value


def from_json(result, name, kind=object):
    """Return the value of an attribute that is JSON text; ParameterError if it is of another kind.

    kind : a type such as dict or list
    """
    written = attribute_text(result, name)
    try:
        value = json.loads(written)
    except (ValueError, RecursionError):
        value = None
    if value is None or not isinstance(value, kind):
        raise refusal("attributes.altered", name=name)
    return value


def recorded_call(result):
    """Return the arguments that made a result, with the cases that the result still has.

    Returns two dicts in SI: the parameters of the slider, and the other arguments that were given.
    Raises ParameterError if the result does not record them.
    """
    if "scenario" not in result.attrs:
        raise refusal("attributes.no_scenario")
    result = in_si(result)
    call = recorded(result)
    followed = call.get("parameter")
    slider = {k: x if k == followed else value_of(result, k, x) for k, x in call["slider"].items()}
    settings = {
        k: _setting(result, k, x) for k, x in call.items() if k not in ("function", "slider")
    }
    return slider, settings


def recorded_loading(result):
    """Return the `Loading` that a result records, or None if it cannot be made again."""
    try:
        has_loading = "loading" in result.attrs  # of a fit, or from an earlier version
        calls = from_json(result, "loading") if has_loading else recorded(result).get("loading")
        return _loading(result, calls)
    except ParameterError:
        return None


def recorded(result):
    """Return the recorded call as a dict; of a fit and an old result, the slider and some more."""
    if "slider" not in result.attrs:
        call = from_json(result, "scenario", dict)
    else:
        call = {name: result.attrs.get(name) for name in ("rtol", "parameter")}
        names = {"slider", "V_lp"} & result.attrs.keys()
        call |= {name: from_json(result, name) for name in names}
    if not isinstance(call.get("slider"), dict):
        raise refusal("attributes.altered", name="scenario")
    return call


def _setting(result, name, value):
    if name == "loading":
        return _loading(result, value)
    if name == "initial":
        return {symbol: _decoded(result, symbol, x) for symbol, x in value.items()}
    return value_of(result, name, value) if name == "V_lp" else _decoded(result, name, value)


def _loading(result, calls):
    loading = Loading
    try:
        for method, given in calls:
            if not hasattr(getattr(Loading, method), "__wrapped__"):  # it is not `recorded`
                raise TypeError
            arguments = {k: _decoded(result, k, x) for k, x in given.items()}
            if "V" in arguments:  # the name of V_lp in results of earlier versions
                arguments["V_lp"] = arguments.pop("V")
            loading = Call(method, arguments).apply_to(loading)
    except ParameterError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
        loading = Loading
    if loading is Loading:
        raise refusal("attributes.altered", name="loading")
    return loading


def value_of(result, symbol, value):
    """Return an argument; a coordinate of its name takes precedence, as in concatenated results."""
    coordinate = result.coords.get(symbol)
    if coordinate is None or isinstance(value, bool) or not isinstance(value, int | float):
        return _decoded(result, symbol, value)
    # a value that was converted to another unit and back may differ in its last digit
    close = np.isclose(coordinate, value, 1e-14, 0.0)
    if coordinate.ndim == 0:
        return value if close else coordinate.item()
    return coordinate if close.any() else value  # others only label a dimension


def _decoded(result, symbol, value):
    """Return an argument from JSON: an array by the name of its variable, else as `_plain`."""
    if isinstance(value, list):
        try:
            return np.array(value, float)
        except (ValueError, TypeError, OverflowError):
            raise refusal("attributes.altered", name="scenario") from None
    if isinstance(value, dict):
        return _array(result, symbol, value)
    return value


def _array(result, symbol, value):
    if "dims" in value:
        return _old_array(result, symbol, value)
    name = value.get("variable")
    if not isinstance(name, str) or name not in result.variables:
        raise refusal("attributes.no_coordinate", symbol=name)
    found = result[name].drop_attrs()
    if found.ndim == 0:
        return found.item()
    if found.dims in (("time",), ("segment",)):
        return found.values
    labels = found.coords.items()
    return found.drop_vars(
        [k for k, v in labels if not v.dims or (k == name and k not in found.dims)]
    )


def _old_array(result, symbol, value):
    """Return an array that an earlier version recorded: dims and values, or a coordinate."""
    dims, values, coordinate = value["dims"], value.get("values"), result.coords.get(symbol)
    if isinstance(values, str) and coordinate is not None:
        return coordinate
    try:
        array = xarray.DataArray(np.asarray(values, float), dims=dims)
    except (ValueError, TypeError, OverflowError):
        raise refusal("attributes.altered", name="slider") from None
    if coordinate is not None:
        is_equal = np.isclose(np.asarray(coordinate)[..., None], array.values.ravel(), 1e-14, 0.0)
        if is_equal.any(axis=-1).all():  # else it only labels a dimension
            return coordinate if coordinate.ndim else coordinate.item()
    if any(result.sizes.get(dim) != size for dim, size in array.sizes.items() if dim != "segment"):
        raise refusal("attributes.no_coordinate", symbol=symbol)
    return array
