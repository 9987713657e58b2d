"""The time limit of a question."""

import contextlib
import threading
import time

from ...engine import backend


class Deadline(threading.Event):
    """An event that is set some seconds after its last `start`, or at once by `set`.

    Parameters
    ----------
    seconds : float
        For each part of the work.
    whole : float
        For all parts, from the first `start` on.
    """

    def __init__(self, seconds, whole=float("inf")):
        super().__init__()
        self.seconds, self.whole = seconds, whole
        self._end = self._last = float("inf")

    def start(self):
        """Start the time limit of a part."""
        now = time.monotonic()
        self._last = min(self._last, now + self.whole)
        self._end = min(self._last, now + self.seconds)

    def is_set(self):
        return super().is_set() or time.monotonic() > self._end

    @property
    def cancelled(self):
        """Whether `set` ended it, and not time."""
        return super().is_set()


@contextlib.contextmanager
def bounded(deadline):
    """Run kernels on one core each, and end them with `backend.Stopped` after the deadline.

    Gives a `Watch` to pass as ``progress``, for runs that keep each step.
    """
    watch = Watch(deadline)
    with backend.use(threads=1, stop=deadline):
        yield watch


class Watch:
    """A ``progress`` callback that stops the work after the deadline, and has the fraction done.

    Kernels check the deadline only every few milliseconds, and many are done sooner.
    """

    def __init__(self, deadline):
        self.deadline, self.done = deadline, 0.0

    def __call__(self, fraction):
        self.done = fraction
        if self.deadline.is_set():
            raise backend.Stopped
