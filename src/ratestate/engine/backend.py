"""Where kernels run: on how many threads, on which device, and until when."""

import contextlib
import contextvars
import threading
from typing import NamedTuple


class Backend(NamedTuple):
    """Settings of kernels: threads (None: one per core), stop event, "cpu" or "cuda"."""

    threads: int | None = None
    stop: threading.Event | None = None
    device: str = "cpu"


_current: contextvars.ContextVar[Backend] = contextvars.ContextVar("backend")


class Stopped(Exception):
    """The event `Backend.stop` was set before the kernels had finished."""


def current():
    """Return the `Backend` of this thread; in a new thread, `Backend()`."""
    return _current.get(Backend())


def check_stopped():
    """Raise `Stopped` if `Backend.stop` of this thread is set."""
    stop = current().stop
    if stop and stop.is_set():
        raise Stopped


@contextlib.contextmanager
def use(**settings):
    """Run the kernels that this thread starts inside on `Backend(**settings)`.

    A setting that is left out has its default, whatever an enclosing `use` says.  The device is not
    checked here: `sweep` does that.
    """
    token = _current.set(Backend(**settings))
    try:
        yield
    finally:
        _current.reset(token)
