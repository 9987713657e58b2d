"""A laboratory record dropped on the page: what is drawn, and what a person can choose."""

import io
import json
from typing import Any

import numpy as np
from pydantic import BaseModel

import ratestate as rs

from . import wire
from .picture import decimated
from .state import with_unit

#: seconds that the reading may take
SECONDS = 60.0
LONGEST = 255  # characters of a file's name
#: table of an error's sentence -> what helps on the page, in place of an argument of `read_lab`
REMEDIES = {
    "columns": "Choose the column below.",
    "units": "Choose its unit, or another column, below.",
    "column": "Choose another column, or its unit, below.",
    "window": "Give other times below.",
    "rows": "Give the times from which and to which it is read, below, or mend the file.",
    "segments": "Give the times from which and to which it is read, below.",
}


class Choices(BaseModel, extra="forbid", strict=True):
    """What the page lets a person choose, keyword arguments of `read_lab`."""

    columns: dict[str, Any] = {}
    units: dict[str, Any] = {}
    time: list[str | None] = []


def choices_of(text):
    """Return the choices in a JSON text as keyword arguments of `read_lab`; `wire.BadQuestion`."""
    choices = wire.checked(Choices, text).model_dump(exclude_unset=True)
    if "time" in choices:
        choices["time"] = [t and with_unit("t", t) for t in choices["time"]]
    return choices


def answer_record(name, contents, choices, stop):
    """Return the answer, of kind "record", to a file of this name with these bytes.

    It has the `quantities` for which a column can be chosen, the file's columns, [[title, unit],
    ...], and which of them was `chosen`, symbol -> number from 1; and either the record or the
    `problem`, why there is none.

    stop : threading.Event that ends the reading
    """
    file = io.BytesIO(contents)
    file.name = name = name[-LONGEST:] or "the file"
    found = rs.lab.try_reading(file, choices, seconds=SECONDS, stop=stop)
    header = {"name": name, "columns": found.columns, "chosen": found.chosen}
    header["quantities"] = quantities()
    if found.error is not None:
        return wire.answer(None, "record", problem=_problem(found), **header)
    record = found.record
    header |= {"found": record.attrs["found"], "notes": json.loads(record.attrs["notes"])}
    header |= {"begin": _begin(record), "conditions": conditions(record)}
    return wire.answer(None, "record", _arrays(record), problem="", **header)


def quantities():
    """Return list of dicts, one a quantity of columns: symbol, name, and example of a unit."""
    return [
        {"symbol": symbol, "name": rs.quantities.QUANTITIES[symbol].long_name, "unit": unit}
        for symbol, unit in rs.lab.EXAMPLE_UNIT.items()
    ]


def _problem(found):
    """Return what is wrong, with a remedy that the page has."""
    table = found.error.sentence.partition(".")[0]
    own = REMEDIES.get(table) if found.columns else None
    return str(rs.ParameterError(found.error.problem, own)) if own else str(found.error)


def _arrays(record):
    """Friction, and the speed of the load point if that was recorded, in time; and the segments."""
    curves = {name: record[name].values for name in ("friction", "V_load") if name in record}
    which = decimated(*curves.values())
    arrays = {name: values[which] for name, values in curves.items()}
    segments = {name: record[name].values for name in ("segment_t", "segment_V")}
    return {"time": record.time.values[which], **arrays, **segments}


def _begin(record):
    """Time [s] of the first step or hold; of a record without one, its first."""
    return float(record.segment_t[1 if record.sizes["segment"] > 1 else 0])


def conditions(record):
    """Return what the page's fields can take from a record, a dict in SI; None if it is missing.

    time : of the first step from one speed to another, neither 0; or as `_begin`
    V_from, V_lp : before and after it; without a step V_lp is the first speed that is not 0
    sigma : the median of the recorded normal stress
    """
    t, V = record.segment_t.values, record.segment_V.values
    steps = np.flatnonzero((V[:-1] > 0.0) & (V[1:] > 0.0))
    sliding = V[V > 0.0]
    found = {"time": _begin(record), "V_from": None, "V_lp": sliding[0] if sliding.size else None}
    if steps.size:
        first = steps[0]
        found = {"time": t[first + 1], "V_from": V[first], "V_lp": V[first + 1]}
    sigma = float(np.median(record.sigma)) if "sigma" in record else None
    return {k: v if v is None else float(v) for k, v in found.items()} | {"sigma": sigma}
