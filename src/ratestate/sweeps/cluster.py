"""Run a sweep on the workers of a Dask cluster, although any of them may die.

Dask gives the tasks of a worker that died to others, unless several workers died with a task.
"""

import asyncio
import contextlib
import itertools
import json
import pickle
import time
from typing import Any, NamedTuple

from ..dynamics.recipe import versions
from ..errors import ParameterError, RateStateError, SolverError
from ..model.arrays import isel
from . import sentence
from .progress import to_stderr
from .tasks import call_on_worker

# Chunks under way for each thread of the cluster, so that no thread waits for its next one.
CHUNKS_PER_THREAD = 2
# Seconds between two checks for finished tasks; between two checks for workers; until a message
# says that there are no workers.
TICK, COUNT_INTERVAL, PATIENCE = 0.05, 1.0, 3.0


class Cluster:
    """The workers of a Dask cluster, as a backend of a sweep: see `tasks.Threads`.

    jobs : `slurm.Jobs` of the workers, or None
    """

    shared = False

    def __init__(self, client, device, jobs=None):
        self.client, self.device, self.jobs = client, device, jobs
        self.threads, self.last_worker, self.last_count = 0, time.monotonic(), -COUNT_INTERVAL

    @property
    def thread_count(self):
        """Number of threads that the cluster has or, with jobs, will have; at least 1."""
        if self.jobs:
            return self.jobs.thread_count
        return max(1, sum(self.client.nthreads().values()))

    def run(self, function, *arguments):
        """Have a worker call a function, with kernels on one thread, and return its result."""
        calls, expected = iter([(function, *arguments)]), {"versions": json.loads(versions())}
        with contextlib.closing(self._results(calls, expected)) as found:
            return next(found)

    def outcomes(self, tasks, call, numbers, report, expected):
        """Solve the chunks with these numbers; yield each `Outcome` when it is ready.

        StoreError unless workers have the expected origin.  SolverError if the cluster is lost.
        """
        calls = ((tasks.solve, i, isel(call, tasks.chunks.slices(i))) for i in numbers)
        yield from self._results(calls, expected, report.refresh)

    def _results(self, calls, expected, refresh=lambda: None):
        """Have workers do calls, each a function and its arguments; yield results in any order."""
        from distributed import CancelledError
        from distributed.client import ClosedClientError

        under_way: dict = {}  # future of a call -> future of its answer here
        try:
            while True:
                free = CHUNKS_PER_THREAD * max(1, self._count_threads()) - len(under_way)
                for call in itertools.islice(calls, max(0, free)):
                    future, answer = self._submit(expected, call)
                    under_way[future] = answer
                if not under_way:
                    return
                ended = [future for future, answer in under_way.items() if answer.done()]
                for future in ended:
                    result = _result_of(under_way[future])  # one that raises is cancelled below
                    del under_way[future]
                    yield result
                if not ended:
                    time.sleep(TICK)
                refresh()
        except RateStateError:
            raise
        except (CancelledError, ClosedClientError, OSError) as error:
            reason = getattr(error, "reason", error)
            raise SolverError(sentence("cluster.lost", error=reason)) from error
        finally:
            if self.client.status == "running":
                self.client.cancel([*under_way])

    def _submit(self, expected, call):
        """Have a worker do a call; return its future and the future of its answer here."""
        task = _CallWhenUnpickled(call_on_worker, (expected, self.device, *call))
        future = self.client.submit(pickle.loads, pickle.dumps(task), pure=False)
        # An answer may be lost with its worker, and then takes long to be computed again.  Waiting
        # for it with `future.result()` would hide other answers, and that there are no workers.
        fetched = self.client.gather(future, asynchronous=True)
        loop = self.client.loop.asyncio_loop
        return future, asyncio.run_coroutine_threadsafe(fetched, loop)

    def _count_threads(self):
        """Return the number of threads of the cluster, as of the last second.

        ConnectionError if the scheduler is gone; SolverError if no job is left.
        """
        now = time.monotonic()
        if now - self.last_count < COUNT_INTERVAL:
            return self.threads
        if self.client.status != "running":
            raise ConnectionError("its scheduler is gone")
        self.last_count, self.threads = now, sum(self.client.nthreads().values())
        if self.threads:
            self.last_worker = now
        elif now - self.last_worker > PATIENCE:
            self.last_worker = float("inf")  # one message is enough
            to_stderr("ratestate: the cluster has no workers. Waiting for some ...")
        if self.jobs:
            self.jobs.maintain()
        return self.threads


class _CallWhenUnpickled(NamedTuple):
    """A call that takes place where this is unpickled: in the task.

    So the scheduler need not be able to import the function, and a worker that cannot import it
    fails in this task only.  If Dask did the unpickling, such a worker would die.
    """

    function: Any
    arguments: tuple

    def __reduce__(self):
        return self.function, self.arguments


def _result_of(answer):
    """Return the result of a task that has ended; an unexpected error becomes a SolverError."""
    from distributed import CancelledError, KilledWorker

    try:
        return answer.result()
    except (RateStateError, CancelledError):
        raise
    except KilledWorker as error:
        raise SolverError(sentence("cluster.workers_die")) from error
    except Exception as error:
        error_text = f"{type(error).__name__}: {error}"
        raise SolverError(sentence("cluster.worker", error=error_text)) from error


def import_extra(module):
    """Import a module that the extra `cluster` installs."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(sentence("cluster.not_installed", module=module)) from None
