"""The loading in a result: the calls that made it, written and made again."""

import json

import numpy as np

from ..errors import ParameterError
from ..model.load_point import Call
from ..model.loading import METHODS, Loading
from ..model.quantities import QUANTITIES
from ..model.units import is_array
from . import attributes
from .refusals import refusal
from .results import MANY, plain


def record_loading(result, loading):
    """Put the calls that made a loading into a result, in place.

    They are JSON in the attribute ``loading``: a list of [method, {argument: value in SI}].  In
    place of more than `MANY` numbers stands the name of a variable that has them.
    """
    record = []
    for number, call in enumerate(loading.calls):
        given = {}
        for name, value in call.arguments.items():
            given[name] = value.tolist() if isinstance(value, np.ndarray) else plain(value)
            if np.size(value) > MANY:
                given[name] = f"loading_{number}_{name}"
                dims = value.dims if is_array(value) else ("segment",)
                unit = QUANTITIES[call.symbol(name)].unit
                labels = {"units": unit, "long_name": f"loading {call.method} {name}"}
                result[given[name]] = (dims, np.asarray(value), labels)
        record.append([call.method, given])
    result.attrs["loading"] = json.dumps(record)


def recorded_loading(result):
    """The `Loading` that a result records, with the cases that the result still has.

    ParameterError if the record is altered or from an earlier version, and if the result has lost
    cases of a swept speed or normal stress.
    """
    record = attributes.from_json(result, "loading")
    if isinstance(record, dict):
        raise refusal("attributes.old_loading")
    loading = Loading
    try:
        for method, given in record:
            if method not in METHODS:
                raise TypeError
            arguments = {name: _argument(result, value) for name, value in given.items()}
            loading = Call(method, arguments).apply_to(loading)
    except ParameterError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, OverflowError):
        loading = Loading
    if loading is Loading:
        raise refusal("attributes.loading")
    return loading


def known_loading(result):
    """The `recorded_loading` of a result; None if it cannot be made again."""
    try:
        return recorded_loading(result)
    except ParameterError:
        return None


def _argument(result, value):
    """An argument of a call, from JSON or a variable of the result."""
    if isinstance(value, list):
        return np.array(value, float)
    if isinstance(value, dict):
        return with_labels(result, attributes.array("loading", value))
    if not isinstance(value, str):
        return value
    array = result[value].reset_coords(drop=True).drop_attrs()
    return array.values if array.dims == ("segment",) else with_labels(result, array)


def with_labels(result, recorded):
    """A recorded array over some of the result's dimensions, with the result's labels."""
    for dim, size in recorded.sizes.items():
        if dim != "segment" and result.sizes.get(dim) != size:
            raise ParameterError(
                (
                    f"the result holds {result.sizes.get(dim, 1)} of {size} cases along {dim!r}, "
                    "and does not say which"
                ),
                "Give all of them.",
            )
    coords = {
        name: c.variable
        for name, c in result.coords.items()
        if set(c.dims) <= set(recorded.dims) and c.dims and name != "time"
    }
    return recorded.drop_vars(recorded.coords).assign_coords(coords)
