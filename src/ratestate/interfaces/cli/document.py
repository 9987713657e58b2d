"""A result as one JSON document, for machines."""

import json
import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    from .verdict_text import VerdictText

# Attributes of a result that hold JSON.
NESTED = (
    *("slider", "V_lp", "V_start", "t_end", "initial", "loading", "versions"),
    *("free", "columns", "notes"),  # of a fit
)


def document(result: "xarray.Dataset", verdict: "VerdictText | None" = None) -> str:
    """A result as strict JSON: numbers in SI, null for what is unknown.

    Keys: ``ratestate`` (version), ``title``, ``dims`` (name -> size), ``coords`` and
    ``data_vars`` (name -> ``dims``, ``attrs`` with ``units`` and ``long_name``, ``data``; complex
    ones as NAME_real and NAME_imag), ``attrs`` (what it was made with), ``failed`` (cases), and for
    one slider ``verdict`` (``about``: the motion it is about; ``regime``, null if it names none;
    ``text``).  Infinite numbers are the strings "inf" and "-inf".
    """
    from ...files import split

    whole = split(result).to_dict()
    attrs = {k: json.loads(v) if k in NESTED else v for k, v in whole["attrs"].items()}
    content = {
        "ratestate": version("ratestate"),
        "title": attrs.pop("title"),
        "dims": whole["dims"],
        "coords": whole["coords"],
        "data_vars": whole["data_vars"],
        "attrs": attrs,
        "failed": failed(result),
    }
    if verdict:
        content["verdict"] = verdict._asdict()
    return strict_json(content)


def strict_json(value: Any) -> str:
    """A value as JSON without the extensions of Python's, such as NaN."""
    return json.dumps(_json_value(value), allow_nan=False)


def _json_value(value: Any) -> Any:
    """A value converted to types that JSON has."""
    if isinstance(value, dict):
        return {str(key): _json_value(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_json_value(one) for one in value]
    if hasattr(value, "tolist"):
        return _json_value(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def failed(result: "xarray.Dataset") -> int:
    """Number of cases without an answer."""
    from ...sweeps.solve import count_failed

    return count_failed(result.variables) if "message" in result else 0
