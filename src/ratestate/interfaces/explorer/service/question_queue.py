"""A queue of questions of one kind, answered one at a time in threads."""

import asyncio

from ....engine.backend import Stopped
from ..computation.budget import Deadline
from ..messages import wire
from ..messages.answers import run_job


class QuestionQueue:
    """A queue of questions, each answered by all jobs in turn: (question, deadline) -> bytes.

    Of a job that fails the answer is the last one; the others would fail as well.
    A part of a job may take `seconds`, and all of it `whole`.  Of more than `capacity` questions
    the oldest is dropped.  A job goes on for `patience` [s] after a newer question has come, or,
    if that is None, to its end.
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

    async def work(self, prepare, send):
        """Answer questions until cancelled, each after `prepare` (question), by `send` (bytes)."""
        loop = asyncio.get_running_loop()
        while True:
            question = await self.waiting.get()
            await prepare(question)
            for job in self.jobs:
                if self.patience is not None and not self.waiting.empty():
                    break  # for a newer question, which came between two jobs
                deadline = self.deadline = Deadline(self.seconds, self.whole)
                deadline.start()
                work = loop.run_in_executor(self.pool, run_job, job, question, deadline)
                try:
                    reply, failed = await work
                except Stopped:
                    break  # for a newer question
                finally:
                    deadline.set()
                await send(reply)
                if failed:
                    break
