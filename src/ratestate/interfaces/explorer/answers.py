"""The answers to questions about a slider, as bytes: question and deadline in."""

from . import branch, charts, picture, wire
from .entries import state_of


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
