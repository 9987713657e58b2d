"""Chunks that may take their process down: done in another, until the case that does is found."""

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import time
from typing import Any

from ..engine import backend
from ..errors import RateStateError, SolverError
from ..model.arrays import cut
from .chunks import halves
from .solve import joined, lost, solve
from .task import Tasks

# Halvings of a part that took its process down before parts are tried again: a new process takes
# longer than many small parts.
HALVINGS = 4
# Seconds that a case is not yet blamed for the end of its process: whoever kills the worker as well
# (SLURM kills all processes of a job) has done so by then.
GRACE = 1.0


class Apart(Tasks):
    """Tasks that a worker has done in a process of their own, since they may kill it."""

    def do(self, i, part, *_):
        """Solve chunk i, the cases of the call `part`, but for those that kill; `Outcome`."""
        with contextlib.closing(_Process(self.device, self.kinds)) as process:
            return self.outcome(i, _divided(process, part, self.kinds))


def _divided(process, part, kinds, level=1):
    """Variables of a part of which some cases may take the process down.

    level : halvings that made it, or 1 for a whole chunk, which need not be tried as it is
    """
    if level % HALVINGS == 0 or part.batch.n == 1:
        variables = process.solve(part)
        if variables is not None:
            return variables
        if part.batch.n == 1:
            time.sleep(GRACE)
            return lost(part, kinds, f"its process died, {process.died}")
    dim, pieces = halves(part.batch.sizes)
    parts = [_divided(process, cut(part, piece), kinds, level + 1) for piece in pieces]
    return joined(parts, dim)


class _Process:
    """A child process that solves parts of a sweep; there is another after its death."""

    def __init__(self, device, kinds):
        self.what, self.died = (device, kinds), ""
        self.process: Any = None

    def solve(self, part):
        """Variables of a part; None if it killed the process.  Errors as of `solve.solve`."""
        if self.process is None:
            self._start()
        try:
            _put(part, self.process.stdin)
            answer = pickle.load(self.process.stdout)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            code = self.close()
            self.died = f"signal {-code}" if code < 0 else f"exit code {code}"
            return None
        if isinstance(answer, RateStateError):
            raise answer
        return answer

    def _start(self):
        code = f"from {__name__} import _serve; _serve()"
        path = os.pathsep.join(filter(None, sys.path))  # what this process can import, that can too
        self.process = subprocess.Popen(
            [sys.executable, "-c", code],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": path},
        )
        try:
            _put(self.what, self.process.stdin)
            pickle.load(self.process.stdout)  # it says that it is there
        except (EOFError, BrokenPipeError) as error:
            raise SolverError(
                f"a worker cannot start a process (exit code {self.close()}); see the worker's log"
            ) from error

    def close(self):
        """End the process; its exit code."""
        process, self.process = self.process, None
        if process is None:
            return 0
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()  # which ends it
        process.stdout.close()
        return process.wait()


def _put(thing, stream):
    pickle.dump(thing, stream)
    stream.flush()


def _serve():
    """Solve the parts that come in, until there are no more: what a child process does."""
    for asked_to_end in (signal.SIGINT, signal.SIGTERM):  # so is the worker, which ends this
        signal.signal(asked_to_end, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that nothing else gets in between them
    device, kinds = pickle.load(sys.stdin.buffer)
    _put("ready", answers)
    with backend.use(threads=1, device=device), contextlib.suppress(EOFError):
        while True:
            part = pickle.load(sys.stdin.buffer)
            try:
                _put(solve(part, kinds), answers)
            except RateStateError as error:  # of no single case
                _put(error, answers)
