"""Answer a question about a slider, as bytes, within a time limit."""

import logging

import ratestate as rs

from . import branch, charts, picture, wire
from .deadline import TimeUp
from .entries import BadEntries, completed, protocol_of, state_of, values_of
from .experiment import slide_hold_slide

log = logging.getLogger("ratestate_explorer")

#: ask -> the chart that the answer is for
PLACES = {"chart": "map", "window": "map", "branch": "branch"}


def answer_picture(question, deadline):
    """Answer "picture"."""
    header, arrays = picture_of(question.entries, deadline)
    return wire.answer(question.id, "picture", arrays, **header)


def picture_of(entries, deadline):
    """Return header and arrays of the answer to "picture"."""
    header, arrays = picture.picture(state_of(entries), deadline)
    return header | {"texts": completed(entries), "protocol": protocol_of(entries)}, arrays


def answer_chart(question, deadline, size=None):
    """Answer "chart" at one size, or "window" at its own."""
    slider = state_of(question.entries).slider
    limits = question.window if question.ask == "window" else charts.WHOLE
    header, arrays = charts.chart(slider, size or charts.WINDOW_SIZE, deadline, limits)
    return wire.answer(question.id, question.ask, arrays, **header)


def answer_branch(question, deadline):
    """Answer "branch"."""
    header, arrays = branch.branch(state_of(question.entries), question.along, deadline)
    return wire.answer(question.id, "branch", arrays, **header)


def answer_rows(question, deadline):
    """Answer "slide-hold-slide"."""
    rows = slide_hold_slide(state_of(question.entries), question.hold)
    return wire.answer(question.id, "rows", rows=rows)


def run_job(job, question, deadline):
    """Return the answer of a job, of kind "problem" if it failed, and whether it did.

    `Stopped` if it was cancelled.
    """
    place = PLACES.get(question.ask, "")  # of a problem that is not one of an entry
    try:
        return job(question, deadline), False
    except BadEntries as error:
        problems = error.problems
    except rs.RateStateError as error:
        problems = {place: str(error)}
    except TimeUp:
        seconds = min(deadline.seconds, deadline.total)
        problems = {
            place: f"{question.ask}: the computation takes more than {seconds:g} s. In Python it "
            f"has no such limit."
        }
    except Exception:
        # `Stopped`; or the program may be ending, and its threads with it
        if deadline.cancelled:
            raise rs.Stopped from None
        log.exception("a question could not be answered: %r", question)
        problems = {place: "The explorer had an internal error. Its terminal shows the details."}
    header = {"values": values_of(question.entries), "protocol": protocol_of(question.entries)}
    return wire.answer(question.id, "problem", problems=problems, **header), True
