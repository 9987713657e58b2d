"""The answers to questions about a slider, as bytes: question and deadline in."""

import logging

from ....engine.backend import Stopped
from ....errors import RateStateError
from ..computation import branch, charts, picture
from ..computation.budget import TimeUp
from ..page_state.entries import BadEntries, state_of, values_of
from . import wire

log = logging.getLogger("ratestate.interfaces.explorer")

#: ask -> the chart that the answer is for
PLACES = {"chart": "map", "window": "map", "branch": "branch"}


def answer_picture(question, deadline):
    """Answer "picture"."""
    header, arrays = picture.picture(state_of(question.entries), deadline)
    return wire.answer(question.id, "picture", arrays, **header)


def answer_chart(question, deadline, size):
    """Answer "chart" at one size."""
    header, arrays = charts.chart(state_of(question.entries).slider, size, deadline)
    return wire.answer(question.id, "chart", arrays, **header)


def answer_window(question, deadline):
    """Answer "window"."""
    slider = state_of(question.entries).slider
    header, arrays = charts.window(slider, question.window, deadline)
    return wire.answer(question.id, "window", arrays, **header)


def answer_branch(question, deadline):
    """Answer "branch"."""
    header, arrays = branch.branch(state_of(question.entries), question.along, deadline)
    return wire.answer(question.id, "branch", arrays, **header)


def run_job(job, question, deadline):
    """The answer of a job, of kind "problem" if it failed, and whether it did.

    backend.Stopped if it was cancelled.
    """
    place = PLACES.get(question.ask, "")  # of what is wrong with no entry
    try:
        return job(question, deadline), False
    except BadEntries as error:
        problems = error.problems
    except RateStateError as error:
        problems = {place: str(error)}
    except TimeUp:
        seconds = min(deadline.seconds, deadline.whole)
        message = f"{question.ask}: this takes more than {seconds:g} s; Python has no such limit"
        problems = {place: message}
    except Exception:
        # by `Stopped`; or the program may be ending, and its threads with it
        if deadline.cancelled:
            raise Stopped from None
        log.exception("a question could not be answered: %r", question)
        problems = {place: "the explorer failed on this; its terminal says more"}
    values = values_of(question.entries)
    return wire.answer(question.id, "problem", problems=problems, values=values), True
