"""Chunks that may kill their process: solved in another, and divided to find the case that does."""

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
from ..model.arrays import isel
from . import sentence
from .chunks import halves
from .solve import concatenate, crashed_variables, solve
from .task import Tasks

# How often a part that killed its process is halved before the pieces are tried: starting a process
# takes longer than solving many small parts.
HALVINGS = 4
# Seconds to wait before a case is blamed for the end of its process: if the worker is being killed
# too (SLURM kills all processes of a job), it is dead by then.
GRACE = 1.0


class SubprocessTasks(Tasks):
    """Tasks that a worker runs in a process of their own, since they may kill it."""

    def do(self, i, part, *_):
        """Solve chunk i, whose cases are those of the call `part`; return its `Outcome`.

        Cases that kill the process get the status ``crashed``.  SolverError if none can be started.
        """
        with contextlib.closing(_Process(self.device, self.specs)) as process:
            return self.outcome(i, _solve_divided(process, part, self.specs))


def _solve_divided(process, part, specs, level=1):
    """Variables of a part of which some cases may kill the process.

    level : number of halvings so far, or 1 for a whole chunk, which has been tried already
    """
    if level % HALVINGS == 0 or part.batch.n == 1:
        variables = process.solve(part)
        if variables is not None:
            return variables
        if part.batch.n == 1:
            time.sleep(GRACE)
            return crashed_variables(part, specs, f"its process died, {process.died}")
    dim, pieces = halves(part.batch.sizes)
    parts = [_solve_divided(process, isel(part, piece), specs, level + 1) for piece in pieces]
    return concatenate(parts, dim)


class _Process:
    """A child process that solves parts of a sweep; when it dies, the next part starts another."""

    def __init__(self, device, specs):
        self.setup, self.died = (device, specs), ""
        self.process: Any = None

    def solve(self, part):
        """Variables of a part; None if it killed the process.  Raises what `solve.solve` does."""
        if self.process is None:
            self._start()
        try:
            _send(part, self.process.stdin)
            answer = pickle.load(self.process.stdout)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            code = self.close()
            self.died = f"signal {-code}" if code < 0 else f"exit code {code}"
            return None
        if isinstance(answer, RateStateError):
            raise answer
        return answer

    def _start(self):
        path = os.pathsep.join(filter(None, sys.path))  # it can import what this process can
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-c", f"from {__name__} import _serve; _serve()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": path},
        )
        try:
            _send(self.setup, self.process.stdin)
            pickle.load(self.process.stdout)  # it is ready
        except (EOFError, BrokenPipeError) as error:
            raise SolverError(sentence("cluster.subprocess", code=self.close())) from error

    def close(self):
        """End the process and return its exit code."""
        process, self.process = self.process, None
        if process is None:
            return 0
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()  # which ends it
        process.stdout.close()
        return process.wait()


def _send(thing, stream):
    pickle.dump(thing, stream)
    stream.flush()


def _serve():
    """Main loop of the child process: solve parts from stdin until there are no more."""
    for number in (signal.SIGINT, signal.SIGTERM):  # the worker gets these too, and ends this
        signal.signal(number, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever else is printed must not mix with the answers
    device, specs = pickle.load(sys.stdin.buffer)
    _send("ready", answers)
    with backend.use(threads=1, device=device), contextlib.suppress(EOFError):
        while True:
            part = pickle.load(sys.stdin.buffer)
            try:
                _send(solve(part, specs), answers)
            except RateStateError as error:  # not due to a single case
                _send(error, answers)
