"""Calls that are slow, raise or kill; in a module that the workers of a sweep import quickly."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from ratestate.dynamics.cycles.limit_cycle import LimitCycleCall
from ratestate.dynamics.steady_sliding import StabilityCall

BAD = [(i, 1) for i in (5, 17)]  # places of bad cases among (24, 2)


def bad(call):
    """Whether there are bad cases, of masses and speeds in equal steps, among those of a call."""
    cases = [(10 ** (2.0 + 3.0 * i / 23), (2e-3, 1e-1)[j]) for i, j in BAD]
    flat = np.transpose([call.batch.flat("M"), call.batch.flat("V_lp")])
    return any(np.isclose(flat, case, rtol=1e-9).all(axis=1).any() for case in cases)


class Slow(LimitCycleCall):
    """Takes its time, and counts how many of its kind do so at once in this process."""

    now = most = 0

    def run(self, progress=None):
        Slow.now += 1
        Slow.most = max(Slow.most, Slow.now)
        time.sleep(0.1)
        Slow.now -= 1
        return super().run(progress)


class Deadly(LimitCycleCall):
    """Kills its process if there are bad cases."""

    def run(self, progress=None):
        if bad(self):
            os.kill(os.getpid(), signal.SIGKILL)
        return super().run(progress)


class Held(StabilityCall):
    """Ends, on a worker, once a file is there."""

    def run(self, progress=None):
        while "HELD_UNTIL" in os.environ and not Path(os.environ["HELD_UNTIL"]).exists():
            time.sleep(0.02)
        return super().run(progress)
