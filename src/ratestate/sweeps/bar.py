"""How far a sweep has come: a bar on a terminal, a line now and then in a log."""

import math
import sys
import time

import numpy as np

from ..dynamics.progress import Bar, duration, on_terminal

# Seconds between two lines of a log.
LOG_EVERY = 30.0


class Report:
    """Counts the cases of a sweep; shows, on stderr, cases done, failures, rate and time left.

    Parameters
    ----------
    label : str
    chunks : Chunks
    done : (chunks,) bool
        Those done by earlier sessions.
    failed : int
        Cases of theirs that failed.
    quiet : bool
        Whether to show nothing.
    """

    def __init__(self, label, chunks, done, failed, quiet):
        self.label, self.chunks = label, chunks
        self.quiet = quiet or sys.stderr is None
        self.total = math.prod(chunks.sizes.values())
        self.before = sum(chunks.cases(i) for i in np.flatnonzero(done))
        self.done, self.failed = self.before, failed
        self.parts: dict = {}  # chunk under way -> fraction done
        self.begin = self.logged = time.monotonic()
        self.bar = Bar(label, self.total)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.bar.__exit__()

    def part(self, i, fraction):
        """This much of chunk i is done; called by the threads that do it."""
        self.parts[i] = fraction

    def finished(self, outcome):
        """A chunk is done."""
        self.parts.pop(outcome.chunk, None)
        self.done += self.chunks.cases(outcome.chunk)
        self.failed += outcome.failed
        self.show()

    def text(self, now):
        """Cases done, failures, rate and time left, in words."""
        done = self.done + sum(
            fraction * self.chunks.cases(i) for i, fraction in list(self.parts.items())
        )
        rate = (done - self.before) / max(now - self.begin, 1e-9)
        words = f"{done:,.0f} of {self.total:,} cases, {self.failed:,} failed"
        if rate > 0.0:
            words += f", {rate:,.3g} cases/s" if rate < 10.0 else f", {rate:,.0f} cases/s"
            words += f", {duration((self.total - done) / rate)} left"
        return done, words

    def show(self):
        """Bring what is seen up to date."""
        now = time.monotonic()
        if self.quiet or not self.bar.due:
            return
        done, words = self.text(now)
        try:
            if on_terminal():
                self.bar.show(done, words)
            elif now - self.logged > LOG_EVERY:
                self.logged = now
                sys.stderr.write(f"{self.label}: {words}\n")
                sys.stderr.flush()
        except OSError:  # whoever read it is gone; the work goes on
            self.quiet = True
