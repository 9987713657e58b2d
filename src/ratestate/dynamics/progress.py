"""Progress bars on a terminal, for work that takes more than a second."""

import contextlib
import math
import os
import sys
import time
from typing import Any

from ..engine import backend

PATIENCE = 1.0  # s


def on_terminal():
    """Return whether stderr is a terminal that a person looks at.

    In a notebook stderr passes for a terminal, but its output stays in the file.
    """
    if sys.stderr is None or "JPY_PARENT_PID" in os.environ:
        return False
    return sys.stderr.isatty() and not type(sys.stderr).__module__.startswith("ipykernel")


class Bar:
    """A bar on stderr, which appears once work has taken a second, and disappears at its end."""

    def __init__(self, label, total=1.0):
        self.label, self.total = label, total
        self.begin = time.monotonic()
        self.drawn: Any = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.drawn is not None:
            self.drawn.stop()

    @property
    def is_due(self):
        """Whether the work has taken long enough for a bar."""
        return time.monotonic() - self.begin >= PATIENCE

    def show(self, done, description):
        """Draw at once how much of the total is done, followed by a description."""
        if self.drawn is None:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn

            self.drawn = Progress(
                self.label,
                BarColumn(),
                TextColumn("{task.description}"),
                console=Console(stderr=True),
                transient=True,
            )
            self.drawn.add_task(description, total=self.total)
            self.drawn.start()
        self.drawn.update(self.drawn.task_ids[0], completed=done, description=description)


@contextlib.contextmanager
def bar(label):
    """Give a function that draws the fraction done as `Bar`; None without a terminal.

    With a function of `backend.use`, or an event that stops the work, it calls that function and
    raises `Stopped`: kernels of one orbit at a time are too short to look.  The second of work
    counts from the first call on, when kernels have been compiled.
    """
    settings = backend.current()
    if settings.progress or settings.stop:

        def report(fraction):
            backend.check_stopped()
            if settings.progress:
                settings.progress(fraction)

        yield report
        return
    if not on_terminal():
        yield None
        return
    with Bar(label) as shown_bar:
        shown_bar.begin = math.inf

        def update(fraction):
            shown_bar.begin = min(shown_bar.begin, time.monotonic())
            if shown_bar.is_due:
                description = f"{fraction:4.0%}"
                if fraction > 0.0:
                    passed = time.monotonic() - shown_bar.begin
                    description += f", {duration(passed * (1.0 / fraction - 1.0))} left"
                shown_bar.show(fraction, description)

        yield update


def duration(seconds):
    """Return a duration [s] as text: 40 s, 3 min 20 s, 1 h 0 s, 2 d 3 h."""
    parts = []
    for size, unit in ((86400, "d"), (3600, "h"), (60, "min"), (1, "s")):
        count, seconds = divmod(seconds, size)
        if count or unit == "s":
            parts.append(f"{count:.0f} {unit}")
    return " ".join(parts[:2])
