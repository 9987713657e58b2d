"""Chunks that may kill their process: solved in another, and divided to find the case that does."""

import contextlib
import time

from ..engine import backend
from ..errors import RateStateError, SolverError
from ..machine import Child, ChildDied
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
            return crashed_variables(part, specs, process.failure)
    dim, pieces = halves(part.batch.sizes)
    parts = [_solve_divided(process, isel(part, piece), specs, level + 1) for piece in pieces]
    return concatenate(parts, dim)


class _Process:
    """A child process that solves parts of a sweep; when it dies, the next part starts another."""

    def __init__(self, device, specs):
        self.setup, self.failure = (device, specs), ""
        self.context = contextlib.ExitStack()
        self.child: Child | None = None

    def solve(self, part):
        """Variables of a part; None if it killed the process, or failed as no part should.

        Raises the RateStateError of `solve.solve`; SolverError if no process can be started.
        """
        if self.child is None:
            self.child = self.context.enter_context(Child(_solve))
        try:
            return self.child.call((*self.setup, part))
        except RateStateError:  # not due to a single case
            raise
        except ChildDied:
            ending = self.child.ending()
            if not self.child.ready:
                raise SolverError(sentence("cluster.subprocess", ending=ending)) from None
            self.failure = f"its process died, {ending}"
            self.close()
        except Exception as error:  # a case that no solver foresees must not end the sweep
            self.failure = f"it failed, {type(error).__name__}: {error}"
        return None

    def close(self):
        """End the process."""
        self.context.close()
        self.child = None


def _solve(task):
    device, specs, part = task
    with backend.use(threads=1, device=device):
        return solve(part, specs)
