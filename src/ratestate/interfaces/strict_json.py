"""JSON without Python's extensions, such as NaN: for the command line and the explorer."""

import json
import math
from typing import Any


def strict_json(value: Any, nan: str | None = None) -> str:
    """A value as strict JSON.

    Complex numbers become pairs, infinite ones the strings "inf" and "-inf", and NaN `nan`, by
    default null; arrays become lists, keys strings.  TypeError for what JSON has not.
    """
    return json.dumps(_json_value(value, nan), allow_nan=False)


def _json_value(value: Any, nan: str | None) -> Any:
    """A value converted to types that JSON has."""
    if isinstance(value, dict):
        return {str(key): _json_value(one, nan) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_json_value(one, nan) for one in value]
    if isinstance(value, complex):
        return [_json_value(value.real, nan), _json_value(value.imag, nan)]
    if hasattr(value, "tolist"):  # of NumPy
        return _json_value(value.tolist(), nan)
    if isinstance(value, float) and not math.isfinite(value):
        return nan if math.isnan(value) else str(value)
    return value
