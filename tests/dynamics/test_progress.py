"""Progress bars: where they appear, and after how much work."""

import io
import sys

import pytest

import ratestate as rs
from ratestate.dynamics import progress
from ratestate.paper.parameters import FIG2


class Terminal(io.StringIO):
    def isatty(self):
        return True


class NotebookStream(Terminal):
    """As ipykernel's, which says that it is a terminal."""


NotebookStream.__module__ = "ipykernel.iostream"


@pytest.mark.parametrize(
    ("stream", "environment", "expected"),
    [
        (Terminal(), {}, True),
        (io.StringIO(), {}, False),
        (None, {}, False),
        (NotebookStream(), {}, False),
        (Terminal(), {"JPY_PARENT_PID": "1"}, False),  # a command that a notebook runs
    ],
)
def test_bars_are_for_a_person_at_a_terminal(stream, environment, expected, monkeypatch):
    monkeypatch.delenv("JPY_PARENT_PID", raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "stderr", stream)
    assert progress.on_terminal() == expected
    with progress.bar("work") as update:
        assert (update is not None) == expected


def test_a_bar_appears_after_a_second_of_work(monkeypatch):
    """What is before the first report, such as compiling, is no work."""
    now, shown = [100.0], []
    monkeypatch.setattr(progress, "on_terminal", lambda: True)
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(progress.Bar, "show", lambda self, done, text: shown.append((done, text)))
    with progress.bar("work") as update:
        now[0] = 130.0
        update(0.01)
        now[0] = 130.99
        update(0.2)
        assert shown == []
        now[0] = 131.0
        update(0.25)
    assert shown == [(0.25, " 25%, 3 s left")]


def test_a_function_of_the_user_replaces_the_bar():
    told = []
    loading = rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s"))
    with rs.use(progress=told.append):
        rs.simulate(FIG2, loading, t_end=11)
        assert told[-1] == 1.0
        told.clear()
        rs.orbit(FIG2, "3.2 mm/s")
    assert told
    assert told == sorted(told)


@pytest.mark.parametrize(
    "setting", [{"device": "gpu"}, {"threads": 0}, {"threads": 1.5}, {"threads": "2"}]
)
def test_impossible_settings_are_refused(setting):
    with pytest.raises(rs.ParameterError, match=next(iter(setting))), rs.use(**setting):
        pass
