"""Chunks of a sweep on the workers of a Dask cluster, whatever happens to these."""

import asyncio
import contextlib
import itertools
import pickle
import queue
import time
from collections import Counter
from typing import Any, NamedTuple

from ..dynamics.results import versions
from ..engine import backend
from ..errors import RateStateError, SolverError
from ..model.arrays import cut
from .apart import Apart
from .jobs import RESUME, Jobs, say
from .task import do_elsewhere

# Chunks sent ahead for each thread of the cluster, so that none waits for the next.
AHEAD = 2
# Workers that a chunk may take with it: the first, and those that then do it `Apart`.
MOST_DEATHS = 4
# Seconds between two looks at what has finished; between two at who is there; until it is said
# that nobody is.
TICK, LOOK, PATIENCE = 0.05, 1.0, 3.0


def outcomes(client, tasks, call, numbers, report):
    """Do the chunks with these numbers, and yield their `Outcome`s as they come.

    A chunk that was on a worker when it died is done again `Apart`, where it can kill no other;
    one whose worker had to go, since its SLURM job ended, is just done again.
    """
    from distributed import CancelledError, KilledWorker

    waiting, deaths = iter(numbers), Counter[int]()

    def send(i):
        how = Apart(*tasks) if deaths[i] else tasks
        work.send(i, do_elsewhere, how, i, cut(call, tasks.chunks.places(i)), versions())

    def suspect(i):
        deaths[i] += 1
        if deaths[i] > MOST_DEATHS:
            raise SolverError(_OVERWHELMED)
        send(i)

    with _connected(), contextlib.closing(_Work(client)) as work:
        while True:
            room = AHEAD * max(1, work.threads()) - len(work.under_way)
            for i in itertools.islice(waiting, max(0, room)):
                send(i)
            if not work.unfinished:
                return
            for i, job_ended in work.bereft():
                send(i) if job_ended else suspect(i)
            for i, answer in work.finished():
                try:
                    outcome = answer.result()
                except KilledWorker:  # many times, before word of it came here
                    suspect(i)
                except (RateStateError, CancelledError):
                    raise
                except Exception as error:
                    raise _useless(error) from error
                else:
                    yield outcome
            report.show()


def _useless(error):
    return SolverError(
        f"a worker cannot do its work ({type(error).__name__}: {error}); it needs the same "
        f"programs as this process; its log may say more"
    )


_OVERWHELMED = (
    f"workers die, one after the other, and not of single cases; give them more memory, or the "
    f"sweep a smaller chunk; {RESUME}"
)


def threads(client):
    """How many threads a cluster has, or is to have."""
    jobs = _jobs(client)
    return max(1, jobs.threads if jobs else sum(client.nthreads().values()))


def _jobs(client):
    """The SLURM jobs of a client's cluster, if it has such; else None."""
    jobs = getattr(client.cluster, "jobs", None)
    return jobs if isinstance(jobs, Jobs) else None


def result(client, device, function, *arguments):
    """What a function returns that a worker calls, with its kernels on one thread."""
    from distributed import CancelledError, KilledWorker

    with _connected(), contextlib.closing(_Work(client)) as work:
        work.send(0, do_elsewhere, _Call(device, function, arguments), None, None, versions())
        while not (ended := work.finished()):
            work.threads()
        try:
            found, raised = ended[0][1].result()
        except (RateStateError, CancelledError, KilledWorker):
            raise
        except Exception as error:
            raise _useless(error) from error
    if raised:
        raise raised
    return found


class _Call(NamedTuple):
    """A function and its arguments."""

    device: str
    function: Any
    arguments: tuple
    kind: Any = None  # any kind of processor will do

    def do(self, *_):
        """What it returns, and None; or None, and what it raises."""
        try:
            with backend.use(threads=1, device=self.device):
                return self.function(*self.arguments), None
        except Exception as error:
            return None, error


class _WhereUnpickled(NamedTuple):
    """A call that takes place where this is unpickled.

    So the scheduler need not know the function, and a worker that does not know it fails in the
    task; it would die of it, and be gone, if Dask unpickled it.
    """

    function: Any
    arguments: tuple

    def __reduce__(self):
        return self.function, self.arguments


class _Work:
    """Numbered tasks under way on a cluster."""

    def __init__(self, client):
        self.client = client
        self.under_way: dict = {}  # number of a task -> its future, and its answer, once it is here
        self.jobs = _jobs(client)
        self.lost: Any = queue.SimpleQueue()  # key of a task, address of its worker, when it died
        self.given_up: dict = {}  # number of such a task -> (address, when)
        self.there, self.seen, self.looked = 0, time.monotonic(), -LOOK
        client.subscribe_topic("all", self._hear)

    def send(self, i, function, *arguments):
        """Have a worker call a function."""
        call = pickle.dumps(_WhereUnpickled(function, arguments))
        future = self.client.submit(pickle.loads, call, pure=False)
        # An answer may be lost with its worker, and take long to come again.  Who waits for that,
        # as `future.result()` does, sees no other answers, nor that there are no workers.
        fetched = self.client.gather(future, asynchronous=True)
        loop = self.client.loop.asyncio_loop
        self.under_way[i] = future, asyncio.run_coroutine_threadsafe(fetched, loop)

    def finished(self):
        """(number, answer) of tasks that have ended; waits a little if there are none."""
        ended = [(i, answer) for i, (_, answer) in self.under_way.items() if answer.done()]
        if not ended:
            time.sleep(TICK)
        for i, _ in ended:
            del self.under_way[i]
        return ended

    def _hear(self, event):
        """Take note of what a worker was at when it died; called by the client's thread."""
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker":
            for key in () if message.get("expected") else message["processing-tasks"]:
                self.lost.put((key, message["worker"], time.monotonic()))

    @property
    def unfinished(self):
        """Whether there is anything left to wait for."""
        return bool(self.under_way or self.given_up)

    def bereft(self):
        """(number, whether its job has ended) of tasks whose worker died; they are given up.

        Without `Jobs` no job has ended; with them a task comes when SLURM has said so or not.
        """
        lost = dict(self._lost())
        found = {i: future for i, (future, _) in self.under_way.items() if future.key in lost}
        for i, future in found.items():
            del self.under_way[i]
            self.given_up[i] = lost[future.key]
        if found:
            self.client.cancel(list(found.values()))
        ended = {i: self._job_has_ended(*death) for i, death in self.given_up.items()}
        known = [(i, whether) for i, whether in ended.items() if whether is not None]
        for i, _ in known:
            del self.given_up[i]
        return known

    def _lost(self):
        for _ in range(self.lost.qsize()):
            key, *death = self.lost.get()
            yield key, death

    def _job_has_ended(self, address, died):
        return self.jobs.has_ended(address, died) if self.jobs else False

    def threads(self):
        """How many threads the cluster has; says so if there are none for a while."""
        now = time.monotonic()
        if now - self.looked < LOOK:
            return self.there
        if self.client.status != "running":
            raise ConnectionError("its scheduler is gone")
        self.looked, self.there = now, sum(self.client.nthreads().values())
        if self.there:
            self.seen = now
        elif now - self.seen > PATIENCE:
            self.seen = float("inf")  # said once
            say("the cluster has no workers; waiting for some ...")
        if self.jobs:
            self.jobs.keep()
        return self.there

    def close(self):
        """Give up what is under way."""
        if self.client.status == "running":
            self.client.unsubscribe_topic("all")
            self.client.cancel([future for future, _ in self.under_way.values()])


@contextlib.contextmanager
def _connected():
    """Let the loss of a cluster be a `SolverError`."""
    from distributed import CancelledError
    from distributed.client import ClosedClientError

    try:
        yield
    except RateStateError:
        raise
    except (CancelledError, ClosedClientError, OSError) as error:
        raise SolverError(
            f"the cluster is lost ({getattr(error, 'reason', error)}); {RESUME}, with another "
            f"cluster or without"
        ) from error
