"""Where kernels run: on how many threads, on which device, and until when."""

import contextlib
import contextvars
import threading
from typing import NamedTuple


class Backend(NamedTuple):
    """How many threads (None: one a core), what stops them, and the device: "cpu" or "cuda"."""

    threads: int | None = None
    stop: threading.Event | None = None
    device: str = "cpu"


_current: contextvars.ContextVar[Backend] = contextvars.ContextVar("backend")


class Stopped(Exception):
    """The event `Backend.stop` was set before the kernels were done."""


def current():
    """The `Backend` of kernels that this thread starts; of a new thread, `Backend()`."""
    return _current.get(Backend())


def check_stopped():
    """Raise `Stopped` where this thread's `Backend.stop` is set."""
    stop = current().stop
    if stop and stop.is_set():
        raise Stopped


@contextlib.contextmanager
def use(**settings):
    """Let kernels that this thread starts inside run on `Backend(**settings)`.

    What is not given has its default, not the value of a `use` around this one.  The device is
    not checked here: `sweep` does that.
    """
    token = _current.set(Backend(**settings))
    try:
        yield
    finally:
        _current.reset(token)
