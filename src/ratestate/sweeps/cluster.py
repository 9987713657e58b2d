"""Chunks of a sweep on the workers of a Dask cluster, whatever happens to these."""

import contextlib
import itertools
import pickle
import queue
import sys
import time
from typing import Any, NamedTuple

from ..arrays import cut
from ..dataset import versions
from ..engine import drive
from ..errors import RateStateError, SolverError
from .apart import Apart
from .task import do_elsewhere

# Chunks sent ahead for each thread of the cluster, so that none waits for the next.
AHEAD = 2
# Seconds between two looks at what has finished; between two at who is there; until it is said
# that nobody is.
TICK, LOOK, PATIENCE = 0.05, 1.0, 3.0


def outcomes(client, tasks, call, numbers, report):
    """Do the chunks with these numbers, and yield their `Outcome`s as they come.

    A chunk that was on a worker when it died is done again `Apart`, where it can kill no other.
    """
    from distributed import CancelledError, KilledWorker

    waiting, apart = iter(numbers), set[int]()

    def send(i):
        how = Apart(*tasks) if i in apart else tasks
        work.send(i, do_elsewhere, how, i, cut(call, tasks.chunks.places(i)), versions())

    with _connected(), contextlib.closing(_Work(client)) as work:
        while True:
            room = AHEAD * max(1, work.threads()) - len(work.under_way)
            for i in itertools.islice(waiting, max(0, room)):
                send(i)
            if not work.under_way:
                return
            for i in work.bereft(but=apart):
                apart.add(i)
                send(i)
            for i, future in work.finished():
                try:
                    outcome = future.result()
                except KilledWorker as error:
                    if i in apart:
                        raise SolverError(_OVERWHELMED) from error
                    apart.add(i)
                    send(i)
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
    "workers die, one after the other, and not of single cases; give them more memory, or the "
    "sweep a smaller chunk; what is stored is whole"
)


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

    def do(self, *_):
        """What it returns, and None; or None, and what it raises."""
        try:
            with drive.place(threads=1, device=self.device):
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
        from distributed import as_completed

        self.client, self.under_way = client, {}
        self.lost: Any = queue.SimpleQueue()  # keys of tasks whose worker died
        self.ready = as_completed(loop=client.loop)
        self.there, self.seen, self.looked = 0, time.monotonic(), -LOOK
        client.subscribe_topic("all", self._hear)

    def send(self, i, function, *arguments):
        """Have a worker call a function."""
        call = pickle.dumps(_WhereUnpickled(function, arguments))
        future = self.client.submit(pickle.loads, call, pure=False)
        self.under_way[future] = i
        self.ready.add(future)

    def finished(self):
        """(number, future) of tasks that have ended; waits a little if there are none."""
        ended = self.ready.next_batch(block=False)
        if not ended:
            time.sleep(TICK)
        return [
            (self.under_way.pop(future), future) for future in ended if future in self.under_way
        ]

    def _hear(self, event):
        """Take note of what a worker was at when it died; called by the client's thread."""
        _, message = event
        if isinstance(message, dict) and message.get("action") == "remove-worker":
            for key in () if message.get("expected") else message["processing-tasks"]:
                self.lost.put(key)

    def bereft(self, but):
        """Numbers of tasks whose worker died; they are given up, but for some."""
        keys = {self.lost.get() for _ in range(self.lost.qsize())}
        found = {f: i for f, i in self.under_way.items() if f.key in keys and i not in but}
        for future in found:
            del self.under_way[future]
        if found:
            self.client.cancel(list(found))
        return list(found.values())

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
            if sys.stderr:
                sys.stderr.write("ratestate: the cluster has no workers; waiting for some ...\n")
                sys.stderr.flush()
        return self.there

    def close(self):
        """Give up what is under way."""
        if self.client.status == "running":
            self.client.unsubscribe_topic("all")
            self.client.cancel(list(self.under_way))


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
            f"the cluster is lost ({getattr(error, 'reason', error)}); what is stored is whole: "
            f"run the same sweep again, with another cluster or without"
        ) from error
