"""Files for download: scenario, Python lines, numbers, a figure; and the page itself."""

import base64
import datetime
from functools import partial
from html import escape
from importlib.metadata import version
from urllib.parse import urlencode

import ratestate as rs

from . import branch, charts, wire
from .answers import answer_branch, answer_chart, picture_of, run_job
from .bundle import bundle
from .deadline import Deadline, TimeUp
from .entries import PORT, BadEntries, address_of, state_of
from .menus import page_data
from .picture import study_of

FIGURES = ("svg", "pdf", "png")
# Largest table to download: some 30 MB.
MOST_ROWS = 200_000

#: seconds of each part of the work where no page waits for it
SECONDS = 300.0
#: what the page says of itself; its address is that of an explorer at the usual port
LINE = """\
<b>Saved page</b> of {date}, by ratestate {version}: what it shows cannot be changed. To go on \
from it, run <code>ratestate explore</code>, then <a href="{live}">open this slider there</a>."""


def answer_file(question, deadline):
    """Answer a download."""
    return wire.answer(question.id, "file", **export(question, deadline))


def export(question, deadline):
    """Return name, type and content (bytes) of one of `wire.FILES`, which the question names.

    ParameterError for more than `MOST_ROWS`, and where a figure has no run; `TimeUp` past the
    deadline, `Stopped` if cancelled.
    """
    kind, state = question.ask, state_of(question.entries)
    try:
        pinned = [state_of(entries) for entries in question.pinned]
    except BadEntries as error:
        raise rs.ParameterError(f"a run kept for comparison: {error}") from None
    if kind == "page":
        content = standalone(question.entries, question.pinned, deadline).encode()
    elif kind in FIGURES:
        from .figure import figure_file  # which is slow to import

        content = figure_file(kind, state, pinned, deadline)
    else:
        content = _text(kind, state, deadline).encode()
    name, of_type = wire.FILES[kind]
    return {"name": name, "type": of_type, "content": content}


def _text(kind, state, deadline):
    plan = study_of(state, deadline).plan
    exported = rs.scenario.Scenario("simulate", plan.slider, plan.settings)
    if kind == "scenario":
        return rs.scenario.toml(exported)
    if kind == "python":
        return f"{rs.scenario.python(exported)}print(result)\n"
    try:
        with deadline.part():
            run = plan.run()
    except rs.SolverError as error:
        run = error.best  # up to where it fails
    if run.sizes["time"] > MOST_ROWS:
        raise rs.ParameterError(
            f"the run has {run.sizes['time']} rows, more than the {MOST_ROWS} of a download. The "
            f"Python lines write it in full."
        )
    return rs.files.csv_text(run)


def standalone(entries, pinned, deadline):
    """Return the page as HTML text: a slider, and others beside it, none of which can change.

    entries : as `entries.state_of` reads them; pinned : list of such

    `BadEntries`; `TimeUp` past the deadline, `Stopped` if it was cancelled.
    """
    header, first = _picture(entries, deadline)
    live = address_of(PORT, urlencode(_texts(entries)))
    starts = [{"name": "saved", "title": "as saved", "entries": _texts(entries)}]
    size = charts.size_in_time(state_of(entries).slider, deadline) or charts.SIZES[0]
    rows = [
        _row("hello", None, wire.answer(None, "hello", **page_data(starts), live=live)),
        _row("picture", entries, first),
        *(_row("picture", texts, _picture(texts, deadline)[1]) for texts in pinned),
        _answered_row(partial(answer_chart, size=size), "chart", entries, deadline),
        *(_answered_row(answer_branch, "branch", entries, deadline, along=p) for p in branch.ALONG),
    ]
    origin = {"date": datetime.date.today().isoformat(), "version": version("ratestate")}
    line = LINE.format(**{name: escape(text) for name, text in (origin | {"live": live}).items()})
    return bundle(header["sentences"][0], line, wire.json_bytes(rows).decode())


def save_page(path, entries):
    """Write the page to an HTML file, whole or not at all; return its Path.

    entries : as of `standalone`, and valid; SolverError if they take too long
    """
    path = rs.files.checked_path(path, (".html",))
    key = charts.key_of(state_of(entries).slider)
    if charts.is_mapped(key):
        charts.survey(*key, charts.SIZES[-1])  # it is found at once then
    try:
        text = standalone(entries, (), Deadline(SECONDS))
    except TimeUp:
        raise rs.SolverError(
            f"a part of the page takes more than {SECONDS:g} s to compute. Nothing was saved."
        ) from None
    return rs.files.replace(path, lambda partial: partial.write_text(text, encoding="utf-8"))


def _row(ask, entries, answer, **extra):
    """Return what js/server/recording.js plays if the page asks this."""
    return {"ask": ask, "entries": entries, "answer": base64.b64encode(answer).decode(), **extra}


def _texts(entries):
    return {name: text for name, text in entries.items() if isinstance(text, str)}


def _picture(entries, deadline):
    header, arrays = picture_of(entries, deadline)
    return header, wire.answer(1, "picture", arrays, **header)


def _answered_row(job, ask, entries, deadline, **extra):
    """Return the row with the answer of a job, or why there is none."""
    reply, _ = run_job(job, wire.Question(1, ask, entries, **extra), deadline)
    return _row(ask, entries, reply, **extra)
