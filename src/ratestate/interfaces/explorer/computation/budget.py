"""The time limit of a question."""

import contextlib
import threading
import time

from ....engine import backend

#: ratio of time to processor time from which a wait is not one for other programs
PATIENCE = 10.0


class TimeUp(Exception):
    """A part of the work took longer than its time limit."""


class Deadline(threading.Event):
    """An event that is set some seconds after its last `start`, or at once by `set`.

    Each part of the work may take `seconds`, and all of it `whole`, from the first `start` on.  On
    a busy machine they count as seconds of the processor, up to `PATIENCE` times as long.  It is
    also a ``progress`` callback, which stops the work after the deadline and has the fraction
    done: kernels check the event only every few milliseconds, and many are done sooner.
    """

    def __init__(self, seconds, whole=float("inf")):
        super().__init__()
        self.seconds, self.whole, self.done = seconds, whole, 0.0
        self._first = self._part = None

    def start(self):
        """Start the time limit of a part, and the whole one if it is the first."""
        self._part, self.done = (time.monotonic(), time.process_time()), 0.0
        self._first = self._first or self._part

    def is_set(self):
        """Whether the time is up, or `set` was called; before the first `start` only the latter."""
        if super().is_set() or self._part is None:
            return super().is_set()
        return _spent(self._part) > self.seconds or _spent(self._first) > self.whole

    @property
    def cancelled(self):
        """Whether `set` ended it, and not time."""
        return super().is_set()

    def __call__(self, fraction):
        self.done = fraction
        if self.is_set():
            raise backend.Stopped

    @contextlib.contextmanager
    def part(self):
        """Start a part of the work, whose kernels run on one core each.

        It is ended with `TimeUp` by time, and with `backend.Stopped` by `set`.
        """
        self.start()
        try:
            with backend.use(threads=1, stop=self):
                yield
        except backend.Stopped:
            if self.cancelled:
                raise
            raise TimeUp from None


def _spent(since):
    """Seconds that this program has worked since a pair of (monotonic, process) times."""
    wall = time.monotonic() - since[0]
    return min(wall, max(time.process_time() - since[1], wall / PATIENCE))
