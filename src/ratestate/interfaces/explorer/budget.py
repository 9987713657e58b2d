"""What one question may cost."""

import contextlib
import threading
import time

from ...engine import backend


class Deadline(threading.Event):
    """Set when it is over: some seconds after its last `start`, or at once by `set`.

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
        """Let the seconds of a part begin."""
        now = time.monotonic()
        self._last = min(self._last, now + self.whole)
        self._end = min(self._last, now + self.seconds)

    def is_set(self):
        return super().is_set() or time.monotonic() > self._end

    @property
    def cancelled(self):
        """Whether somebody ended it, and not time."""
        return super().is_set()


@contextlib.contextmanager
def bounded(deadline):
    """Let kernels inside end with `backend.Stopped` once the deadline is over; on one core each.

    Gives what is to be passed as ``progress``: it watches runs that keep each step.
    """
    watch = Watch(deadline)
    with backend.use(threads=1, stop=deadline):
        yield watch


class Watch:
    """A ``progress`` that stops the work, and knows how far it came.

    Kernels look at the deadline only every few milliseconds, and many are done sooner.
    """

    def __init__(self, deadline):
        self.deadline, self.done = deadline, 0.0

    def __call__(self, fraction):
        self.done = fraction
        if self.deadline.is_set():
            raise backend.Stopped
