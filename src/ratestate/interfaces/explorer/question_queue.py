"""A queue of questions of one kind, answered one at a time in threads."""

import asyncio
import contextlib
import logging

from ...engine.backend import Stopped
from ...errors import RateStateError
from . import wire
from .budget import Deadline, TimeUp
from .entries import BadEntries, values_of

log = logging.getLogger("ratestate.interfaces.explorer")


class QuestionQueue:
    """A queue in which questions wait for their answers.

    Parameters
    ----------
    pool : Executor
    jobs : list of callables (question, deadline) -> bytes
        A question is answered by each in turn.
    seconds, whole : float
        Time limit of a part of a job, and of the whole job.
    capacity : int
        Questions that may wait; if there are more, the oldest is dropped.
    patience : float or None
        Seconds for which a job continues after a newer question has come; None: no limit.
    """

    def __init__(self, pool, jobs, *, seconds, whole=float("inf"), capacity=1, patience=None):
        self.pool, self.jobs, self.patience = pool, jobs, patience
        self.seconds, self.whole = seconds, whole
        self.waiting: asyncio.Queue[wire.Question] = asyncio.Queue(capacity)
        self.deadline = Deadline(seconds)

    def take(self, question):
        """Add a question; return the one that it displaces, or None."""
        dropped = self.waiting.get_nowait() if self.waiting.full() else None
        self.waiting.put_nowait(question)
        if self.patience is not None:
            asyncio.get_running_loop().call_later(self.patience, self.deadline.set)
        return dropped

    async def work(self, ready, send):
        """Answer questions until cancelled.

        ready : Event to wait for first
        send : coroutine function of bytes
        """
        await ready.wait()
        while True:
            question = await self.waiting.get()
            with contextlib.suppress(Stopped):  # for a newer question
                for job in self.jobs:
                    await send(await self._answer(job, question))

    async def _answer(self, job, question):
        """The answer of a job, in bytes; backend.Stopped if it was stopped."""
        deadline = self.deadline = Deadline(self.seconds, self.whole)
        deadline.start()
        try:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self.pool, run_job, job, question, deadline)
        finally:
            deadline.set()


def run_job(job, question, deadline):
    """The answer of a job, or the reason why it failed; backend.Stopped if it was cancelled."""
    try:
        return job(question, deadline)
    except BadEntries as error:
        problems = error.problems
    except RateStateError as error:
        problems = {"": str(error)}
    except TimeUp:
        seconds = min(deadline.seconds, deadline.whole)
        message = f"{question.ask}: this takes more than {seconds:g} s; Python has no such limit"
        problems = {"": message}
    except Exception:
        if (
            deadline.cancelled
        ):  # by `Stopped`; or the program may be ending, and its threads with it
            raise Stopped from None
        log.exception("a question could not be answered: %r", question)
        problems = {"": "the explorer failed on this; its terminal says more"}
    values = values_of(question.entries)
    return wire.answer(question.id, "problem", problems=problems, values=values)
