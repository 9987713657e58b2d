"""Settings of the kernels: threads, device, an event that stops them, progress."""

import contextlib
import contextvars
import threading
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..errors import ParameterError

#: where kernels can run
DEVICES = ("cpu", "cuda")


class Backend(NamedTuple):
    """Settings of kernels; `use` describes them."""

    threads: int | None = None
    stop: threading.Event | None = None
    device: str = "cpu"
    progress: Callable[[float], object] | None = None


_current: contextvars.ContextVar[Backend] = contextvars.ContextVar("backend")


class Stopped(Exception):
    """The event given to `use` has stopped a calculation (this is not a `RateStateError`)."""


def current():
    """Return the `Backend` of this thread; in a new thread, `Backend()`."""
    return _current.get(Backend())


def check_stopped():
    """Raise `Stopped` if `Backend.stop` of this thread is set."""
    stop = current().stop
    if stop and stop.is_set():
        raise Stopped


def check_device_name(device):
    """Raise ParameterError unless this names a device of `DEVICES`."""
    if not isinstance(device, str) or device not in DEVICES:
        remedy = f"Choose one of {', '.join(DEVICES)}."
        raise ParameterError("is unknown", remedy, symbol="device", value=repr(device))


@contextlib.contextmanager
def use(*, threads=None, stop=None, device="cpu", progress=None):
    """Set threads, device, a stop event or progress for calculations in a ``with`` block.

    A setting that is left out has its default, whatever an enclosing `use` says.  The settings hold
    in this thread, and not for `sweep`, which has arguments of its own.

    Parameters
    ----------
    threads : int, optional
        Number of threads, at least 1; by default one per core.
    stop : threading.Event, optional
        Ends the calculations: they raise `Stopped` some milliseconds after it is set, unless they
        are done before.
    device : {"cpu", "cuda"}, optional
        Where sweeps of motions, and cycles, are computed; by default "cpu".  Without an NVIDIA GPU
        they raise `ParameterError` for "cuda".
    progress : callable, optional
        Called with the fraction done (0 to 1), in place of a progress bar; not called if a
        calculation is short.

    Yields
    ------
    None
        Nothing.

    Examples
    --------
    >>> import threading, ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> stop = threading.Event()
    >>> stop.set()  # another thread would do this
    >>> with rs.use(stop=stop):
    ...     rs.orbit(slider, "3.2 mm/s")
    Traceback (most recent call last):
    ratestate.engine.backend.Stopped
    """
    check_device_name(device)
    if threads is not None and not (isinstance(threads, int | np.integer) and threads >= 1):
        raise ParameterError("must be an integer >= 1", symbol="threads", value=repr(threads))
    threads = None if threads is None else int(threads)
    token = _current.set(Backend(threads, stop, device, progress))
    try:
        yield
    finally:
        _current.reset(token)
