"""Write a figure of the run or map on the page to a file."""

import contextlib
import io
import threading
from importlib.metadata import version
from typing import Any
from urllib.parse import urlencode

import matplotlib as mpl

import ratestate as rs

from . import charts
from .entries import SYMBOLS, entries_of
from .picture import decimated, run_of, study_of
from .state import text_of

#: twice the pixels that a page in a browser gives an inch
DPI = 2 * 96
#: settings that no call of matplotlib takes: text that stays text, and fonts that are inside
WRITING: Any = {"pdf.fonttype": 42, "svg.fonttype": "path", "svg.hashsalt": "ratestate"}
# One figure at a time: threads share matplotlib's reader of mathematics and its settings.
_DRAWING = threading.Lock()


def figure_file(form, state, pinned, deadline):
    """Return a figure as bytes; form: "svg", "pdf" or "png"; it raises as `figure_of` does."""
    with _DRAWING:
        fig = figure_of(state, pinned, deadline)
        with _writing():
            return _written(fig, form, state)


def figure_of(state, pinned, deadline):
    """Return the Figure of a `PageState`, with the runs of other states behind it.

    ParameterError if there is no run to draw; `TimeUp` past the deadline, `Stopped` if it
    was cancelled.
    """
    study, run, notes = _motion(state, deadline)
    others = [_motion(other, deadline)[1] for other in pinned]
    size = charts.size_in_time(state.slider, deadline)
    return rs.plot.overview(
        run,
        study.verdict,
        orbit=study.orbit if study.verdict.period else None,
        others=others,
        chart=size and charts.survey(*charts.key_of(state.slider), size),
        caption=_caption(study, state, notes),
    )


def _motion(state, deadline):
    """Return the `Study` of a state, its run with time 0 at the step, and notes."""
    study = study_of(state, deadline)
    run, notes = run_of(study.plan, deadline)
    if run is None:
        raise rs.ParameterError(" ".join(notes))
    stress = run.tau / run.get("sigma", study.plan.slider.sigma)
    run = run.isel(time=decimated(stress.values, run.V.values))
    return study, rs.plot.since(run, study.plan.changes[0]), study.notes + notes


def _caption(study, state, notes):
    """Return paragraphs: the verdict; the slider; and what is not shown."""
    values, before = state.values, state.before
    label = next(law.label for law in rs.laws.catalogue() if law.name == state.slider.law)
    parts = [f"{label},"]
    moment = "in the end" if state.protocol else "since time 0"
    for symbol in dict.fromkeys((*SYMBOLS, *state.slider.friction_law.parameters)):
        text = rs.plot.value_text(symbol, values[symbol])
        if before and before.values[symbol] != values[symbol]:
            earlier = rs.plot.value_text(symbol, before.values[symbol]).partition(" = ")[2]
            text = f"{text} {moment} ({earlier} before)"
        parts.append(f"{text},")
    if state.kick:
        parts.append(f"V times {state.kick:.4g} at time 0,")
    if state.protocol:
        first, *others = text_of(state.protocol).split("; ")
        parts += [f"from time 0: {first},", *(f"{other}," for other in others)]
    parts[-1] = parts[-1].removesuffix(",")
    headline, *_ = study.verdict.sentences
    return [headline.split(" "), parts, *(note.split(" ") for note in notes)]


@contextlib.contextmanager
def _writing():
    """Set `WRITING` for a while, and no other settings, which a user may change meanwhile."""
    before: Any = {name: mpl.rcParams[name] for name in WRITING}
    mpl.rcParams.update(WRITING)
    try:
        yield
    finally:
        mpl.rcParams.update(before)


def _written(fig, form, state):
    """Return a figure as bytes, with what it shows; the same bytes each time."""
    query = urlencode(entries_of(state))
    creator = f"ratestate {version('ratestate')}"
    metadata = {
        "svg": {"Title": "ratestate", "Description": query, "Creator": creator, "Date": None},
        "pdf": {"Title": "ratestate", "Subject": query, "Creator": creator, "CreationDate": None},
        "png": {"Title": "ratestate", "Description": query, "Software": creator},
    }
    buffer = io.BytesIO()
    fig.savefig(buffer, format=form, dpi=DPI, metadata=metadata[form])
    return buffer.getvalue()
