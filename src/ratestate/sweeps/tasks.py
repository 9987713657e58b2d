"""Solve and store chunks of a sweep, on threads or by a worker."""

import itertools
import threading
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from typing import Any, NamedTuple

from ..engine import backend
from ..errors import StoreError
from ..machine import cores
from ..model.arrays import isel
from . import sentence
from .chunks import Chunks
from .identity import origin, origin_differences
from .solve import count_failed, solve
from .store import as_lines
from .writing import write


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

    def solve(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, with the cases of the call `part`; return its `Outcome`.

        If there is a store, its variables go there; StoreError if they cannot be written.
        """
        with backend.use(threads=threads, stop=stop, device=self.device):
            variables = solve(part, self.specs, progress)
        failed = count_failed(variables)
        if self.store is None:
            return Outcome(i, failed, variables)
        write(self.store, i, variables)
        return Outcome(i, failed, None)


class Threads:
    """Threads of this process, on which a sweep runs by default; else see `cluster.Cluster`."""

    shared = True  # whether all threads can work on one chunk

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

        Closing the generator stops those under way.  All threads have the expected origin.
        """
        workers = max(1, min(cores(), len(numbers))) if tasks.device == "cpu" else 1
        threads = -(-cores() // workers)
        stop, queue = threading.Event(), iter(numbers)

        def work(i):
            part = isel(call, tasks.chunks.slices(i))
            return tasks.solve(i, part, lambda fraction: report.part(i, fraction), threads, stop)

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
    current = origin(device)
    if lines := origin_differences({"processor": current["processor"]} | expected, current):
        raise StoreError(sentence("origin.worker", lines=as_lines(lines)))
    with backend.use(threads=1, device=device):
        return function(*arguments)
