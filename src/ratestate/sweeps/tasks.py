"""Chunks of a sweep solved and stored: on threads, by a worker, or in a process of their own."""

import itertools
import threading
import time
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import Any, NamedTuple

from ..engine import backend
from ..errors import SolverError, StoreError
from ..machine import Child, ChildDied, cores
from ..model.arrays import isel
from . import sentence
from .chunks import Chunks
from .inputs import origin, origin_differences
from .solve import concatenate, count_failed, crashed_variables, halves, solve
from .store import as_lines
from .writing import write

# Seconds to wait before a case is blamed for the end of its process: if the worker is being killed
# too (SLURM kills all processes of a job), it is dead by then.
GRACE = 1.0


class Outcome(NamedTuple):
    """The result of a chunk."""

    chunk: int
    failed: int  # cases without an answer
    variables: dict | None  # None: they are in the store


class Tasks(NamedTuple):
    """What all chunks of a sweep share."""

    chunks: Chunks
    specs: dict  # variable -> `VariableSpec`
    store: Any  # `Store`, or None
    device: str

    def solve(self, part, progress=None):
        """Return the variables of all cases of the call `part`."""
        return solve(part, self.specs, progress)

    def do(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, whose cases are those of the call `part`; return its `Outcome`.

        If there is a store, its variables go there; StoreError if they cannot be written.
        """
        with backend.use(threads=threads, stop=stop, device=self.device):
            variables = self.solve(part, progress)
        failed = count_failed(variables)
        if self.store is None:
            return Outcome(i, failed, variables)
        write(self.store, i, variables)
        return Outcome(i, failed, None)


class Threads:
    """Threads of this process, on which a sweep runs by default.

    A backend of a sweep has ``shared``, whether all threads can work on one chunk, ``thread_count``
    and the methods ``run`` and ``outcomes``.  The other backend is `cluster.Cluster`.
    """

    shared = True

    def __init__(self, device):
        if device == "cuda":
            from ..engine import cuda

            cuda.check()

    @property
    def thread_count(self):
        """Number of threads, each with a core."""
        return cores()

    def run(self, function, *arguments):
        """Call a function where the work is to be done, and return its result."""
        return function(*arguments)

    def outcomes(self, tasks, call, numbers, report, expected=None):
        """Solve the chunks with these numbers; yield each `Outcome` when it is ready, in any order.

        Closing the generator stops those under way.

        expected : origin of a cluster's workers; all threads have that of this process
        """
        workers = max(1, min(cores(), len(numbers))) if tasks.device == "cpu" else 1
        threads = -(-cores() // workers)
        stop, queue = threading.Event(), iter(numbers)

        def work(i):
            part = isel(call, tasks.chunks.slices(i))
            return tasks.do(i, part, lambda fraction: report.part(i, fraction), threads, stop)

        pool = ThreadPoolExecutor(workers)
        try:
            pending = {pool.submit(work, i) for i in itertools.islice(queue, workers)}
            while pending:
                finished, pending = wait(pending, timeout=0.1, return_when=FIRST_COMPLETED)
                pending |= {pool.submit(work, i) for i in itertools.islice(queue, len(finished))}
                report.refresh()
                for future in finished:
                    yield future.result()
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)


def call_on_worker(expected, device, function, *arguments):
    """Call a function in a worker process, and return its result.

    StoreError unless the process has the expected origin.  If that lacks a processor, any will do.
    """
    now = origin(device)
    if lines := origin_differences({"processor": now["processor"]} | expected, now):
        raise StoreError(sentence("origin.worker", lines=as_lines(lines)))
    with backend.use(threads=1, device=device):
        return function(*arguments)


class SubprocessTasks(Tasks):
    """Tasks that a worker runs in a process of their own, because they may kill it."""

    def solve(self, part, progress=None):
        """Return the variables of all cases of the call `part`.

        A case that kills its process is found by halving, and gets the status ``crashed``.
        SolverError if no process can be started.
        """
        with Child(_solve) as child:
            try:
                return child.call((self.device, self.specs, part))
            except ChildDied:
                ending = child.ending()
                if not child.ready:
                    raise SolverError(sentence("cluster.subprocess", ending=ending)) from None
        if part.batch.n == 1:
            time.sleep(GRACE)
            return crashed_variables(part, self.specs, f"its process died, {ending}")
        dim, pieces = halves(part.batch.sizes)
        return concatenate([self.solve(isel(part, piece)) for piece in pieces], dim)


def _solve(task):
    device, specs, part = task
    with backend.use(threads=1, device=device):
        return solve(part, specs)
