"""A progress bar for work that takes more than a second, where someone is there to see it."""

import contextlib
import sys
import time
from typing import Any

PATIENCE = 1.0  # s


@contextlib.contextmanager
def bar(label):
    """Give a function of the fraction done; it draws on a terminal, and only after a second."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield None
        return
    begin = time.monotonic()
    shown: Any = None

    def update(fraction):
        nonlocal shown
        if shown is None and time.monotonic() - begin > PATIENCE:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TaskProgressColumn, TimeRemainingColumn

            shown = Progress(
                label,
                BarColumn(),
                TaskProgressColumn(),
                TimeRemainingColumn(),
                console=Console(stderr=True),
                transient=True,
            )
            shown.add_task(label, total=1.0)
            shown.start()
        if shown is not None:
            shown.update(shown.task_ids[0], completed=fraction)

    try:
        yield update
    finally:
        if shown is not None:
            shown.stop()
