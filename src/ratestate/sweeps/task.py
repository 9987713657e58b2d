"""Chunks of a sweep solved, and stored if there is a store: on threads, or by a worker."""

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
from .manifest import as_lines
from .origin import origin, origin_differences
from .solve import count_failed, solve
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

    def outcome(self, i, variables):
        """Store the variables of chunk i, if there is a store; return its `Outcome`.

        StoreError if they cannot be written.
        """
        number = count_failed(variables)
        if self.store is None:
            return Outcome(i, number, variables)
        write(self.store, i, variables)
        return Outcome(i, number, None)

    def do(self, i, part, progress=None, threads=1, stop=None):
        """Solve chunk i, whose cases are those of the call `part`; return its `Outcome`."""
        with backend.use(threads=threads, stop=stop, device=self.device):
            return self.outcome(i, solve(part, self.specs, progress))


class Threads:
    """Threads of this process: where a sweep runs by default.

    A backend of a sweep has ``shared``, whether all threads can work on one chunk, ``thread_count``
    and the methods ``run`` and ``outcomes``; the other one is `cluster.Cluster`.
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

    def outcomes(self, tasks, call, numbers, report, processor=None):
        """Solve the chunks with these numbers; yield each `Outcome` when it is ready, in any order.

        Closing the generator stops those under way.

        processor : for clusters, whose workers may differ; here all have the same
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

    StoreError unless the process has the expected `origin`, of which None as ``processor`` admits
    any.
    """
    now = origin(device)
    if now["versions"] != expected["versions"]:
        versions = {"now": now["versions"], "expected": expected["versions"]}
        raise StoreError(sentence("origin.worker_version", **versions))
    if lines := origin_differences(expected, now):
        raise StoreError(sentence("origin.worker", lines=as_lines(lines)))
    with backend.use(threads=1, device=device):
        return function(*arguments)
