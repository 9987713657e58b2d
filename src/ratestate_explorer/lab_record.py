"""Read a laboratory record that is dropped on the page, in memory only, and answer."""

import asyncio
import contextlib
import io
import json
import warnings
from typing import Any

import numpy as np
from pydantic import BaseModel
from starlette.requests import ClientDisconnect
from starlette.responses import Response

import ratestate as rs

from . import wire
from .deadline import TimeUp
from .entries import BadEntries, state_of
from .picture import decimated
from .state import with_unit

#: bytes of a file, and seconds in which it must be here
LARGEST, SECONDS = 50_000_000, 60.0
#: seconds that the reading may take, and a fit
READING_SECONDS, FITTING_SECONDS = 60.0, 300.0
LONGEST = 255  # characters of a file's name
#: table of an error's sentence -> what helps on the page, in place of an argument of `read_lab`
REMEDIES = {
    "columns": "Choose the column below.",
    "units": "Choose its unit, or another column, below.",
    "column": "Choose another column, or its unit, below.",
    "window": "Give other times below.",
    "rows": "Give the first and last time to read below, or correct the file.",
    "segments": "Give the first and last time to read below.",
}


#: parameters that are fitted; K only if the page's is finite
FREE = ("a", "b", "Dc", "K")


class Refused(Exception):
    """A file is not read; `status` goes into the answer."""

    def __init__(self, status, problem):
        super().__init__(problem)
        self.status = status


async def take_record(request):
    """Answer a POST of a file, whose query has `page`, `name` and perhaps `choices`.

    ``page`` is the token that the page was greeted with; ``choices`` is a JSON object.  Of a page's
    files the newest is read: an earlier one, and that of a page that has gone, is given up.
    """
    try:
        session = _session(request)
        choices = choices_of(request.query_params.get("choices", "{}"))
        length = request.headers.get("content-length", "0")
        if not length.isdecimal() or int(length[:20]) > LARGEST:
            raise Refused(413, too_large())
        stop = session.begin_record()
        contents = await _contents(request, stop)
    except Refused as refused:
        return _response(wire.answer(None, "record", problem=str(refused)), refused.status)
    except wire.BadQuestion as error:
        return _response(wire.answer(None, "record", problem=str(error)), 400)
    except ClientDisconnect:
        return Response(status_code=400)
    name = request.query_params.get("name", "")
    work = asyncio.get_running_loop().run_in_executor(
        session.shared.record_pool, answer_record, name, contents, choices, stop
    )
    del contents
    return _response(await _unless_gone(request, work, stop), 200)


def _session(request):
    page = request.query_params.get("page", "")
    for session in request.app.state.shared.sessions:
        if session.token == page:
            return session
    raise Refused(403, "this page is not connected to ratestate. Wait until it is, and try again.")


async def _contents(request, stop):
    """Return the bytes of the file; Refused if it is not wanted any more."""
    contents = bytearray()
    try:
        async with asyncio.timeout(SECONDS):
            async for chunk in request.stream():
                contents += chunk
                if stop.is_set():
                    raise Refused(
                        409, "another file was sent after this one, or its page was closed"
                    )
                if len(contents) > LARGEST:
                    raise Refused(413, too_large())
    except TimeoutError:
        raise Refused(408, f"the file did not arrive within {SECONDS:g} s. Try again.") from None
    return bytes(contents)


def too_large():
    """Return the message for a file that is too large."""
    return (
        f"the file is larger than the {LARGEST / 1e6:g} MB that the page takes. Cut "
        f"the record, or keep every tenth row. In Python read_lab has no such limit."
    )


async def _unless_gone(request, work, stop):
    """Return the result of work, which is stopped if the page does not wait for it any more."""

    async def gone():
        while (await request.receive())["type"] != "http.disconnect":
            pass
        stop.set()

    watch = asyncio.create_task(gone())
    try:
        return await work
    finally:
        watch.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await watch


def _response(message, status):
    return Response(message, status, media_type="application/octet-stream")


class Choices(BaseModel, extra="forbid", strict=True):
    """What the page lets a person choose, keyword arguments of `read_lab`; and `fit`.

    fit : the page's entries, if the record shall be fitted
    """

    columns: dict[str, Any] = {}
    units: dict[str, Any] = {}
    time: list[str | None] = []
    fit: dict[str, Any] = {}


def choices_of(text):
    """Return the `Choices` in a JSON text that are made, a dict; `wire.BadQuestion`."""
    choices = wire.checked(Choices, text).model_dump(exclude_unset=True)
    if "time" in choices:
        choices["time"] = [t and with_unit("t", t) for t in choices["time"]]
    return choices


def answer_record(name, contents, choices, stop):
    """Return the answer, of kind "record", to a file of this name with these bytes.

    It has the `quantities` for which a column can be chosen, the file's columns, [[title, unit],
    ...], and which of them was `chosen`, symbol -> number from 1; and either the record or the
    `problem`, why there is none.  With a fit, the record has `friction_fit`, and `fitted` are
    sentences on it.

    stop : `Deadline` that ends the reading, and the fit
    """
    entries = choices.pop("fit", None)
    file = io.BytesIO(contents)
    file.name = name = name[-LONGEST:] or "the file"
    found = rs.files.try_reading(file, choices, seconds=READING_SECONDS, stop=stop)
    header = {"name": name, "columns": found.columns, "chosen": found.chosen}
    header["quantities"] = quantities()
    if found.error is not None:
        return wire.answer(None, "record", problem=_problem(found), **header)
    record = found.record
    header |= {"found": record.attrs["found"], "notes": json.loads(record.attrs["notes"])}
    header |= {"begin": _begin(record), "conditions": conditions(record), "fitted": []}
    if entries:
        try:
            friction, header["fitted"] = fit_of(record, entries, stop)
        except rs.RateStateError as error:
            return wire.answer(None, "record", problem=str(error), **header)
        except rs.Stopped:
            return wire.answer(None, "record", problem="the fit was stopped", **header)
        record = record.assign(friction_fit=("time", friction))
    return wire.answer(None, "record", _arrays(record), problem="", **header)


def quantities():
    """Return list of dicts, one a quantity of columns: symbol, name, and example of a unit."""
    return [
        {"symbol": symbol, "name": rs.QUANTITIES[symbol].long_name, "unit": unit}
        for symbol, unit in rs.files.EXAMPLE_UNIT.items()
    ]


def _problem(found):
    """Return what is wrong, with a remedy that the page has."""
    table = found.error.sentence.partition(".")[0]
    remedy = REMEDIES.get(table) if found.columns else None
    return str(rs.ParameterError(found.error.problem, remedy)) if remedy else str(found.error)


def _arrays(record):
    """Friction, a fit if any, and the load point's speed if recorded, in time; and segments."""
    names = ("friction", "friction_fit", "V_load")
    curves = {name: record[name].values for name in names if name in record}
    rows = decimated(*curves.values())
    arrays = {name: values[rows] for name, values in curves.items()}
    segments = {name: record[name].values for name in ("segment_t", "segment_V")}
    return {"time": record.time.values[rows], **arrays, **segments}


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


def fit_of(record, entries, deadline):
    """Return the fitted friction (m,) of a record, and sentences: estimates, then warnings.

    ParameterError if the entries or the record cannot be used, and if the time is up;
    `Stopped` if it was cancelled.
    """
    try:
        slider = state_of(entries).slider
    except BadEntries as error:
        raise rs.ParameterError(str(error)) from None
    if "sigma" in record:
        slider = slider.replace(sigma=float(np.median(record.sigma)))
    free = FREE if np.isfinite(slider.K) else FREE[:-1]
    try:
        with deadline.part(), warnings.catch_warnings():
            warnings.simplefilter("ignore", rs.FitWarning)  # they are in the result
            result = rs.fit(record, slider, free)
    except TimeUp:
        raise rs.ParameterError(
            f"the fit takes more than {deadline.seconds:g} s",
            "Give the times of a single step below, or use the command ratestate fit.",
        ) from None
    fitted = np.interp(record.time, result.time, result.friction_fit)
    texts = [f"Fit under the {slider.law} law: {_estimates(result, free)}."]
    return fitted, texts + result.warnings.item().splitlines()


def _estimates(result, free):
    """Return the estimates with their standard errors as text."""
    parts = []
    for name in free:
        value, error = float(result[name]), float(result.standard_error.sel(parameter=name))
        number, _, unit = rs.readable(name, value).partition(" ")
        if np.isfinite(error):
            number += f" \N{PLUS-MINUS SIGN} {error * float(number) / value:.2g}"
        else:
            unit += " (not determined)"
        parts.append(f"{name} = {number} {unit}".rstrip())
    return ", ".join(parts)
