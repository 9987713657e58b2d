"""A result as one JSON document, for machines."""

import json
import math
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    from .spoken import Spoken

# Attributes of a result that hold JSON.
NESTED = (
    *("slider", "V_lp", "V_start", "t_end", "initial", "loading", "versions"),
    *("free", "columns", "notes"),  # of a fit
)


def document(result: "xarray.Dataset", said: "Spoken | None" = None) -> str:
    """A result as text: strict JSON, numbers in SI, null for what is unknown.

    Keys: ``ratestate`` (version), ``title``, ``dims`` (name -> size), ``coords`` and
    ``data_vars`` (name -> ``dims``, ``attrs`` with ``units`` and ``long_name``, ``data``; complex
    ones as NAME_real and NAME_imag), ``attrs`` (what it was made with), ``failed`` (cases), and of
    one slider ``verdict`` (``about``: of what it holds; ``regime``, null where it tells none;
    ``text``).  Infinite numbers are the texts "inf" and "-inf".
    """
    from ...files import split

    whole = split(result).to_dict()
    attrs = {k: json.loads(v) if k in NESTED else v for k, v in whole["attrs"].items()}
    found = {
        "ratestate": version("ratestate"),
        "title": attrs.pop("title"),
        "dims": whole["dims"],
        "coords": whole["coords"],
        "data_vars": whole["data_vars"],
        "attrs": attrs,
        "failed": failed(result),
    }
    if said:
        found["verdict"] = said._asdict()
    return strict(found)


def strict(value: Any) -> str:
    """A value as JSON that every reader takes."""
    return json.dumps(_plain(value), allow_nan=False)


def _plain(value: Any) -> Any:
    """The same of what JSON knows."""
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def failed(result: "xarray.Dataset") -> int:
    """Number of cases without an answer."""
    from ...sweeps.solve import failed

    return failed(result.variables) if "message" in result else 0
