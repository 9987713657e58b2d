"""The workers of a Dask cluster, on which a sweep can run and of which any may die.

Dask gives the tasks of a worker that died to others.  If several workers die with a task, its chunk
is solved where it cannot kill the worker.
"""

import asyncio
import contextlib
import itertools
import json
import pickle
import time
from collections import Counter
from typing import Any, NamedTuple

from ..dynamics.results import versions
from ..errors import ParameterError, RateStateError, SolverError
from ..model.arrays import isel
from . import sentence
from .progress import to_stderr
from .tasks import SubprocessTasks, call_on_worker

# Chunks under way for each thread of the cluster, so that no thread waits for its next one.
AHEAD = 2
# How often a chunk is solved in a process of its own before the workers are blamed: they may have
# died of other chunks.
MOST_TRIES = 3
# Seconds between two checks for finished tasks; between two checks for workers; until a message
# says that there are no workers.
TICK, LOOK, PATIENCE = 0.05, 1.0, 3.0


class Cluster:
    """The workers of a Dask cluster, as a backend of a sweep: see `tasks.Threads`.

    jobs : `slurm.Jobs` of the workers, or None
    """

    shared = False

    def __init__(self, client, device, jobs=None):
        self.client, self.device, self.jobs = client, device, jobs

    @property
    def thread_count(self):
        """Number of threads that the cluster has or, with jobs, will have; at least 1."""
        return max(1, self.jobs.thread_count if self.jobs else thread_count(self.client))

    def run(self, function, *arguments):
        """Have a worker call a function, with kernels on one thread, and return its result.

        An error of ratestate's own in the function is raised here.  SolverError for any other, and
        if the cluster is lost; KilledWorker if the function kills several workers.
        """
        with self._working({"versions": json.loads(versions())}) as work:
            work.send(0, function, *arguments)
            while not (ended := work.finished()):
                work.look()
            return _result_of(ended[0][1])

    def outcomes(self, tasks, call, numbers, report, expected):
        """Solve the chunks with these numbers; yield each `Outcome` when it is ready.

        StoreError unless all workers have the expected origin.  SolverError if the cluster is lost,
        or workers die again and again.
        """
        from distributed import KilledWorker

        waiting, tries = iter(numbers), Counter[int]()

        def send(i):
            how = SubprocessTasks(*tasks) if tries[i] else tasks
            work.send(i, how.do, i, isel(call, tasks.chunks.slices(i)))

        with self._working(expected) as work:
            while True:
                free = AHEAD * max(1, work.look()) - len(work.under_way)
                for i in itertools.islice(waiting, max(0, free)):
                    send(i)
                if not work.under_way:
                    return
                for i, answer in work.finished():
                    try:
                        outcome = _result_of(answer)
                    except KilledWorker:
                        tries[i] += 1
                        if tries[i] > MOST_TRIES:
                            raise SolverError(sentence("cluster.workers_die")) from None
                        send(i)
                    else:
                        yield outcome
                report.refresh()

    @contextlib.contextmanager
    def _working(self, expected):
        """Give a `Work`, and close it in the end; the loss of the cluster is a SolverError."""
        from distributed import CancelledError
        from distributed.client import ClosedClientError

        try:
            with contextlib.closing(Work(self, expected)) as work:
                yield work
        except RateStateError:
            raise
        except (CancelledError, ClosedClientError, OSError) as error:
            reason = getattr(error, "reason", error)
            raise SolverError(sentence("cluster.lost", error=reason)) from error


class Work:
    """Numbered tasks under way on the workers of a `Cluster`, which must have this origin."""

    def __init__(self, cluster, expected):
        self.client, self.jobs = cluster.client, cluster.jobs
        self.setup = expected, cluster.device
        self.under_way: dict = {}  # number of a task -> its future, and that of its answer here
        self.threads, self.last_seen, self.last_look = 0, time.monotonic(), -LOOK

    def send(self, i, *call):
        """Have a worker call a function with arguments, as task i; return at once.

        call : the function, then its arguments
        """
        task = _CallWhenUnpickled(call_on_worker, (*self.setup, *call))
        future = self.client.submit(pickle.loads, pickle.dumps(task), pure=False)
        # An answer may be lost with its worker, and then takes long to be computed again.  Waiting
        # for it with `future.result()` would hide other answers, and that there are no workers.
        fetched = self.client.gather(future, asynchronous=True)
        loop = self.client.loop.asyncio_loop
        self.under_way[i] = future, asyncio.run_coroutine_threadsafe(fetched, loop)

    def finished(self):
        """Return [(number, answer)] of the tasks that have ended since the last call.

        `result()` of an answer gives what the task returned, or raises.  [] after a wait of `TICK`
        if there are none.
        """
        ended = [i for i, (_, answer) in self.under_way.items() if answer.done()]
        if not ended:
            time.sleep(TICK)
        return [(i, self.under_way.pop(i)[1]) for i in ended]

    def look(self):
        """Return the number of threads of the cluster, as of the last second.

        A message on stderr says if there are none for a while.  ConnectionError if the scheduler is
        gone; SolverError if no job is left.
        """
        now = time.monotonic()
        if now - self.last_look < LOOK:
            return self.threads
        if self.client.status != "running":
            raise ConnectionError("its scheduler is gone")
        self.last_look, self.threads = now, thread_count(self.client)
        if self.threads:
            self.last_seen = now
        elif now - self.last_seen > PATIENCE:
            self.last_seen = float("inf")  # one message is enough
            to_stderr("ratestate: the cluster has no workers. Waiting for some ...")
        if self.jobs:
            self.jobs.maintain()
        return self.threads

    def close(self):
        """Cancel what is under way; do nothing if the scheduler is gone."""
        if self.client.status == "running":
            self.client.cancel([future for future, _ in self.under_way.values()])


class _CallWhenUnpickled(NamedTuple):
    """A call that takes place where this is unpickled: in the task.

    So the scheduler need not be able to import the function, and a worker that cannot import it
    fails in this task only.  If Dask did the unpickling, such a worker would die.
    """

    function: Any
    arguments: tuple

    def __reduce__(self):
        return self.function, self.arguments


def thread_count(client):
    """Return the number of threads of a client's workers."""
    return sum(client.nthreads().values())


def _result_of(answer):
    """Return the result of a task that has ended; an unexpected error becomes a SolverError."""
    from distributed import CancelledError, KilledWorker

    try:
        return answer.result()
    except (RateStateError, CancelledError, KilledWorker):
        raise
    except Exception as error:
        what = f"{type(error).__name__}: {error}"
        raise SolverError(sentence("cluster.worker", error=what)) from error


def client_of(address):
    """Return a client of the Dask scheduler at this address, such as "tcp://10.0.0.1:8786".

    ParameterError if it does not answer in 10 s, or distributed is not installed.
    """
    distributed = import_extra("distributed")
    try:
        return distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        message = sentence("cluster.silent", address=address, error=error)
        raise ParameterError(message) from error


def import_extra(module):
    """Import a module that the extra `cluster` installs."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ParameterError(sentence("cluster.not_installed", module=module)) from None
