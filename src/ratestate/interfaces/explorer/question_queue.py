"""Questions of one kind, worked off one at a time in threads."""

import asyncio
import collections
import logging

from ...engine.backend import Stopped
from ...errors import RateStateError
from . import wire
from .budget import Deadline
from .entries import BadEntries, values_of

log = logging.getLogger("ratestate.interfaces.explorer")


class Lane:
    """Where questions wait for their answers.

    Parameters
    ----------
    pool : Executor
    jobs : list of callables (question, deadline) -> bytes
        A question is answered by each in turn.
    seconds, whole : float
        That a part of a job may take, and the job.
    room : int
        Questions that may wait; beyond it the oldest is dropped.
    patience : float or None
        Seconds for which a job goes on after a newer question has come; None for ever.
    """

    def __init__(self, pool, jobs, *, seconds, whole=float("inf"), room=1, patience=None):
        self.pool, self.jobs, self.patience = pool, jobs, patience
        self.seconds, self.whole = seconds, whole
        self.waiting: collections.deque[wire.Question] = collections.deque(maxlen=room)
        self.some = asyncio.Event()
        self.deadline: Deadline | None = None

    def take(self, question):
        """Let a question wait; the one that it drives out, or None."""
        dropped = self.waiting[0] if len(self.waiting) == self.waiting.maxlen else None
        self.waiting.append(question)
        self.some.set()
        if self.deadline and self.patience is not None:
            asyncio.get_running_loop().call_later(self.patience, self.deadline.set)
        return dropped

    async def work(self, ready, send):
        """Answer for ever.

        ready : Event to wait for
        send : coroutine function of bytes
        """
        await ready.wait()
        while True:
            await self.some.wait()
            if not self.waiting:
                self.some.clear()
                continue
            question = self.waiting.popleft()
            for job in self.jobs:
                if (found := await self._done(job, question)) is None:
                    break
                await send(found)

    async def _done(self, job, question):
        """The answer of a job, in bytes; None where a newer question overtook it."""
        deadline = self.deadline = Deadline(self.seconds, self.whole)
        deadline.start()
        loop = asyncio.get_running_loop()
        try:
            return await loop.run_in_executor(self.pool, answered, job, question, deadline)
        except Stopped:
            return None
        finally:
            deadline.set()
            self.deadline = None


def answered(job, question, deadline):
    """What a job answers; where it fails, why, in words.  backend.Stopped if it was cancelled."""
    try:
        return job(question, deadline)
    except BadEntries as error:
        problems = error.problems
    except RateStateError as error:
        problems = {"": str(error)}
    except Stopped:
        if deadline.cancelled:
            raise
        seconds = min(deadline.seconds, deadline.whole)
        told = f"{question.ask}: this takes more than {seconds:g} s; Python has no such limit"
        problems = {"": told}
    except Exception:
        if deadline.cancelled:  # the program may be ending, and its threads with it
            raise Stopped from None
        log.exception("a question could not be answered: %r", question)
        problems = {"": "the explorer failed on this; its terminal says more"}
    read = values_of(question.entries)
    return wire.answer(question.id, "problem", problems=problems, values=read)
