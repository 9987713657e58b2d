"""Show progress of a sweep: a bar on a terminal, or a line every 30 s in a log."""

import math
import sys
import time

import numpy as np

from ..dynamics.progress import Bar, duration, on_terminal

# Seconds between two lines of a log.
LOG_EVERY = 30.0


class ProgressReport(Bar):
    """Shows cases done, failures, rate and time left on stderr.

    done : which chunks earlier sessions did, (chunks,) bool; failed: how many cases of these failed
    """

    def __init__(self, label, chunks, done, failed, quiet):
        super().__init__(label, math.prod(chunks.sizes.values()))
        self.chunks, self.failed = chunks, failed
        self.quiet = quiet or sys.stderr is None
        self.done = self.done_before = sum(chunks.cases(i) for i in np.flatnonzero(done))
        self.fractions: dict = {}  # chunk under way -> fraction done
        self.logged = self.begin

    def part(self, i, fraction):
        """Note which fraction (0 to 1) of chunk i is done; called by the threads that solve it."""
        self.fractions[i] = fraction

    def finished(self, outcome):
        """Note that the chunk of an `Outcome` is done."""
        self.fractions.pop(outcome.chunk, None)
        self.done += self.chunks.cases(outcome.chunk)
        self.failed += outcome.failed
        self.refresh()

    def refresh(self):
        """Update the bar, or write a line to the log when one is due."""
        now = time.monotonic()
        if self.quiet or not self.is_due:
            return
        parts = [fraction * self.chunks.cases(i) for i, fraction in list(self.fractions.items())]
        done = self.done + sum(parts)
        rate = (done - self.done_before) / max(now - self.begin, 1e-9)
        text = f"{done:,.0f} of {self.total:,} cases, {self.failed:,} failed"
        if rate > 0.0:
            text += f", {rate:,.3g} cases/s" if rate < 10.0 else f", {rate:,.0f} cases/s"
            text += f", {duration((self.total - done) / rate)} left"
        try:
            if on_terminal():
                self.show(done, text)
            elif now - self.logged > LOG_EVERY:
                self.logged = now
                to_stderr(f"{self.label}: {text}")
        except OSError:  # nobody reads stderr any more; the work goes on
            self.quiet = True


def to_stderr(text):
    """Write a line to stderr, if the process has one."""
    if sys.stderr:
        sys.stderr.write(f"{text}\n")
        sys.stderr.flush()
