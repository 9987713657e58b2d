"""The time limit of an answer."""

import contextlib
import threading
import time

import ratestate as rs

#: longest wait for other programs, as a multiple of the processor time
PATIENCE = 10.0


class TimeUp(Exception):
    """A part of the work took longer than its time limit."""


class Deadline(threading.Event):
    """An event that is set some seconds after its last `start`, or at once by `set`.

    Each part of the work may take `seconds`, and all parts together `total`, from the first `start`
    on.  On a busy machine seconds of the processor count, up to `PATIENCE` times as long.
    """

    def __init__(self, seconds, total=float("inf")):
        super().__init__()
        self.seconds, self.total, self.done = seconds, total, 0.0
        self._first = self._part = None

    def start(self):
        """Start the time limit of a part, and the limit of all parts with the first one."""
        self._part, self.done = (time.monotonic(), time.process_time()), 0.0
        self._first = self._first or self._part

    def is_set(self):
        """Return whether `set` was called or, after the first `start`, the time is up."""
        if super().is_set() or self._part is None:
            return super().is_set()
        return _seconds_spent(self._part) > self.seconds or _seconds_spent(self._first) > self.total

    @property
    def cancelled(self):
        """Whether `set` ended it, and not time."""
        return super().is_set()

    def record(self, fraction):
        """Record the fraction of the part that is done."""
        self.done = fraction

    @contextlib.contextmanager
    def part(self):
        """Start a part of the work, whose calculations run on one core each.

        It ends with `TimeUp` if the time is up, and with `ratestate.Stopped` if `set` was called.
        """
        self.start()
        try:
            with rs.use(threads=1, stop=self, progress=self.record):
                yield
        except rs.Stopped:
            if self.cancelled:
                raise
            raise TimeUp from None


def _seconds_spent(start):
    """Return the seconds that this program worked since a pair of (monotonic, process) times."""
    wall = time.monotonic() - start[0]
    return min(wall, max(time.process_time() - start[1], wall / PATIENCE))
