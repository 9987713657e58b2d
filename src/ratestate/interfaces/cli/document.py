"""Write a result as one JSON document, for other programs."""

import json
from importlib.metadata import version
from typing import Any

import xarray

from ...files.stored import split
from .verdict_text import VerdictText

# Attributes of a result that hold JSON.
NESTED = (
    *("scenario", "slider", "loading", "versions"),
    *("free", "columns", "notes"),  # of a fit
    *("noise", "remarks"),  # of healing, and of a machine
)


def document(result: xarray.Dataset, verdict: VerdictText | None) -> dict[str, Any]:
    """Return a result for `print_json`: numbers in SI, null if unknown.

    Keys: ``ratestate`` (version), ``title``, ``dims`` (name -> size), ``coords`` and
    ``data_vars`` (name -> ``dims``, ``attrs`` with ``units`` and ``long_name``, ``data``; complex
    ones as NAME_real and NAME_imag), ``attrs`` (what it was made with), ``failed`` (cases), and for
    one slider ``verdict`` (``about``: the motion it is about; ``regime``, null if it names none;
    ``text``).  Infinite numbers are the strings "inf" and "-inf".
    """
    contents = split(result).to_dict()
    attrs = {k: json.loads(v) if k in NESTED else v for k, v in contents["attrs"].items()}
    return {
        "ratestate": version("ratestate"),
        "title": attrs.pop("title"),
        **{key: contents[key] for key in ("dims", "coords", "data_vars")},
        "attrs": attrs,
        "failed": failed(result),
        **({"verdict": verdict._asdict()} if verdict else {}),
    }


def failed(result: xarray.Dataset) -> int:
    """Return the number of cases without an answer, or of steps without a fit."""
    if "message" not in result:
        return 0
    if "step" in result.dims:
        from ...records.fitting.steps import FAILED

        return int((result["status"] == FAILED).sum())
    from ...sweeps.solve import count_failed

    return count_failed(result.variables)
