"""Tasks under way on a Dask cluster, whose workers may die."""

import asyncio
import contextlib
import json
import pickle
import time
from typing import Any, NamedTuple

from ..dynamics.recipe import versions
from ..errors import RateStateError, SolverError
from . import sentence
from .jobs import Jobs
from .progress import to_stderr
from .task import call_on_worker

# Seconds between two checks for finished tasks; between two checks for workers; until a message
# says that there are no workers.
TICK, LOOK, PATIENCE = 0.05, 1.0, 3.0


def jobs_of(client):
    """The `Jobs` of a client's cluster; None if it has none."""
    jobs = getattr(client.cluster, "jobs", None)
    return jobs if isinstance(jobs, Jobs) else None


class _CallWhenUnpickled(NamedTuple):
    """A call that takes place where this is unpickled: in the task.

    So the scheduler need not be able to import the function, and a worker that cannot import it
    fails in this task only.  If Dask did the unpickling, such a worker would die.
    """

    function: Any
    arguments: tuple

    def __reduce__(self):
        return self.function, self.arguments


class Work:
    """Numbered tasks under way on a cluster, for a device, and workers of one kind unless None."""

    def __init__(self, client, device, processor):
        self.client, self.device = client, device
        self.expected = {"versions": json.loads(versions()), "processor": processor}
        self.under_way: dict = {}  # number of a task -> its future, and that of its answer here
        self.jobs = jobs_of(client)
        self.deaths: dict = {}  # key of a task -> address of its worker, and time of its death
        self.given_up: dict = {}  # number of such a task -> the same
        self.available, self.last_seen, self.last_look = 0, time.monotonic(), -LOOK
        client.subscribe_topic("all", self._note_death)

    def send(self, i, *call):
        """Have a worker call a function with arguments, as task i; returns at once.

        call : the function, then its arguments
        """
        task = _CallWhenUnpickled(call_on_worker, (self.expected, self.device, *call))
        future = self.client.submit(pickle.loads, pickle.dumps(task), pure=False)
        # An answer may be lost with its worker, and then takes long to be computed again.  Waiting
        # for it with `future.result()` would hide other answers, and that there are no workers.
        fetched = self.client.gather(future, asynchronous=True)
        loop = self.client.loop.asyncio_loop
        self.under_way[i] = future, asyncio.run_coroutine_threadsafe(fetched, loop)

    def finished(self):
        """[(number, answer)] of the tasks that have ended since the last call.

        `result()` of an answer gives what the task returned, or raises.  [] after a wait of `TICK`
        if there are none.
        """
        ended = [i for i, (_, answer) in self.under_way.items() if answer.done()]
        if not ended:
            time.sleep(TICK)
        return [(i, self.under_way.pop(i)[1]) for i in ended]

    def _note_death(self, event):
        """Note the tasks of a worker that died; called by the client's thread."""
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker":
            for key in () if message.get("expected") else message["processing-tasks"]:
                self.deaths[key] = message["worker"], time.monotonic()

    @property
    def unfinished(self):
        """Whether there is a task to wait for."""
        return bool(self.under_way or self.given_up)

    def lost_tasks(self):
        """[(number, whether its job has ended)] of tasks whose worker died; cancels them.

        With `Jobs` a task is listed once the batch system has answered; without, no job has ended.
        """
        for i, (future, _) in list(self.under_way.items()):
            if future.key in self.deaths:
                del self.under_way[i]
                self.client.cancel(future)
                self.given_up[i] = self.deaths.pop(future.key)
        has_ended = self.jobs.has_ended if self.jobs else lambda *_: False
        answers = {i: has_ended(*death) for i, death in self.given_up.items()}
        self.given_up = {i: death for i, death in self.given_up.items() if answers[i] is None}
        return [(i, ended) for i, ended in answers.items() if ended is not None]

    def thread_count(self):
        """Number of threads of the cluster, as of the last second; 0 without workers.

        A message on stderr says if there are none for a while.  ConnectionError if the scheduler is
        gone; SolverError if `Jobs` give up.
        """
        now = time.monotonic()
        if now - self.last_look < LOOK:
            return self.available
        if self.client.status != "running":
            raise ConnectionError("its scheduler is gone")
        self.last_look, self.available = now, sum(self.client.nthreads().values())
        if self.available:
            self.last_seen = now
        elif now - self.last_seen > PATIENCE:
            self.last_seen = float("inf")  # one message is enough
            to_stderr("ratestate: the cluster has no workers; waiting for some ...")
        if self.jobs:
            self.jobs.maintain()
        return self.available

    def close(self):
        """Cancel what is under way; nothing if the scheduler is gone."""
        if self.client.status == "running":
            self.client.unsubscribe_topic("all")
            self.client.cancel([future for future, _ in self.under_way.values()])


@contextlib.contextmanager
def working(client, device, processor=None):
    """Context manager: a `Work`, closed in the end; the loss of the cluster is a `SolverError`."""
    from distributed import CancelledError
    from distributed.client import ClosedClientError

    try:
        with contextlib.closing(Work(client, device, processor)) as work:
            yield work
    except RateStateError:
        raise
    except (CancelledError, ClosedClientError, OSError) as error:
        reason = getattr(error, "reason", error)
        raise SolverError(sentence("cluster.lost", error=reason)) from error
