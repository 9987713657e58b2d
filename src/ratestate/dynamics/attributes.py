"""Reads the attributes of results, which anybody can lose or change; `results` writes them.

Whatever the attributes contain, these functions return a valid value or raise a `ParameterError`.
"""

import json
import numbers

import numpy as np

from ..friction.forms import form_name
from ..friction.laws import law_name
from ..model.quantities import QUANTITIES
from ..model.units import to_si
from .refusals import refusal, sentence

LONGEST = 60  # characters of a value in a message


def attribute(result, name):
    """An attribute of a result, of any type; ParameterError where it is missing."""
    if name not in result.attrs:
        raise refusal("attributes.lost", name=name)
    return result.attrs[name]


def text(result, name, default=None):
    """An attribute that is a string; the default where it is missing.

    ParameterError where it is missing and there is no default, and where it is no string.
    """
    if default is not None and name not in result.attrs:
        return default
    value = attribute(result, name)
    if not isinstance(value, str):
        raise _altered(name, value, "text")
    return value


def number(result, name):
    """An attribute that is a number, as a float, which may be infinite.

    ParameterError where it is missing, no number, or NaN; for a key of `QUANTITIES` also where it
    is out of the quantity's range.
    """
    value = attribute(result, name)
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.item()
    return to_si(name, _plain(name, value)) if name in QUANTITIES else _plain(name, value)


def from_json(result, name, kind=object):
    """The value of an attribute that is JSON text.

    ParameterError where it is missing, no JSON, or not of this kind, a type such as dict or list.
    """
    written = text(result, name)
    try:
        value = json.loads(written)
    except (ValueError, RecursionError) as error:
        why = f"{type(error).__name__}: {error}"
        raise _altered(name, written, "json", why=why) from None
    if not isinstance(value, kind):
        raise _altered(name, written, "json_kind", kind=kind.__name__)
    return value


def parameter_value(name, symbol, value):
    """The value that `results.plain` put into JSON: a float or DataArray [SI], or a name.

    ParameterError where it is none, or out of the quantity's range.

    name, symbol : of the attribute, and of the quantity, or "law" or "friction"
    """
    if symbol == "law":
        return law_name(value)
    if symbol == "friction":
        return form_name(value)
    if isinstance(value, dict):
        values = array(name, value)
        to_si(symbol, values)  # checks it
        return values
    return to_si(symbol, _plain(name, value))


def array(name, value):
    """The DataArray, of floats, given as a dict ``{"dims": [...], "values": [...]}``.

    ParameterError where these do not fit together, or there is no value; a null becomes NaN.  That
    `value` is a dict is not checked.

    name : of the attribute, for the message
    """
    import xarray

    dims = value.get("dims")
    try:
        values = np.asarray(value.get("values"), float)
        if isinstance(dims, list) and values.size and values.ndim == len(dims):
            return xarray.DataArray(values, dims=[str(dim) for dim in dims])
    except (ValueError, TypeError, OverflowError):
        pass
    raise _altered(name, value, "array")


def branch_parameter(result):
    """Symbol of the parameter that changes along a branch of cycles.

    ParameterError where the attribute is missing, or names nothing that lies along ``point``.
    """
    symbol = text(result, "parameter")
    if symbol not in QUANTITIES or "point" not in getattr(result.get(symbol), "dims", ()):
        raise _altered("parameter", symbol, "branch_parameter")
    return symbol


def _plain(name, value):
    """A number as a float, which may be infinite."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or value != value:
        raise _altered(name, value, "number")
    try:
        return float(value)
    except OverflowError:
        raise _altered(name, value, "size") from None


def _altered(name, value, expected, **values):
    """The error about an attribute; expected : name of a sentence in [expected]."""
    shown = repr(value)
    shown = shown if len(shown) <= LONGEST else shown[: LONGEST - 3] + "..."
    wanted = sentence(f"expected.{expected}", **values)
    return refusal("attributes.altered", name=name, shown=shown, wanted=wanted)
