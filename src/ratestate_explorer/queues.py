"""Queues of questions, answered one at a time in threads, and the kernels that they need."""

import asyncio
import contextlib
from typing import NamedTuple

import ratestate as rs

from . import wire
from .answers import run_job
from .deadline import Deadline

#: seconds in which the kernels of a kind must be loaded: on some machines they are compiled
SECONDS = 300.0


class QuestionQueue:
    """A queue of questions, each answered by all jobs in turn: (question, deadline) -> bytes.

    After a job that fails the others are left out, because they would fail too.  A part of a job
    may take `seconds`, and all of it `total`.  If more than `capacity` questions wait, the oldest
    is dropped.  A job goes on for `patience` [s] after a newer question has come, or to its end if
    `patience` is None.
    """

    def __init__(self, pool, jobs, *, seconds, total=float("inf"), capacity=1, patience=None):
        self.pool, self.jobs, self.patience = pool, jobs, patience
        self.seconds, self.total = seconds, total
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
                deadline = self.deadline = Deadline(self.seconds, self.total)
                deadline.start()
                work = loop.run_in_executor(self.pool, run_job, job, question, deadline)
                try:
                    reply, failed = await work
                except rs.Stopped:
                    break  # for a newer question
                finally:
                    deadline.set()
                await send(reply)
                if failed:
                    break


class Kind(NamedTuple):
    """The properties that decide which kernels a page needs."""

    law: str
    friction_form: str
    symbols: tuple[str, ...]  # of the parameters that law, friction and damping bring
    sigma_varies: bool


def kind_of(state):
    """Return the `Kind` of a `PageState`."""
    slider = state.slider
    symbols = tuple(slider.friction_law.parameters)
    return Kind(slider.law, slider.friction_form, symbols, state.sigma_varies)


class Kernels:
    """The kinds that are ready; `warm_up` (kind, deadline) prepares one in a thread of the pool."""

    def __init__(self, pool, warm_up):
        self.pool, self.warm_up = pool, warm_up
        self.deadline = Deadline(SECONDS)
        self.tasks: dict[Kind, asyncio.Task] = {}

    def are_ready(self, kind):
        """Return whether the kernels of a kind are loaded."""
        return kind in self.tasks and self.tasks[kind].done()

    async def prepare(self, kind):
        """Wait until the kernels of a kind are loaded."""
        if kind not in self.tasks:
            self.tasks[kind] = asyncio.create_task(self._load(kind))
        await asyncio.shield(self.tasks[kind])

    async def _load(self, kind):
        loop = asyncio.get_running_loop()
        with contextlib.suppress(rs.Stopped):
            await loop.run_in_executor(self.pool, self.warm_up, kind, self.deadline)

    def close(self):
        """End all preparations."""
        self.deadline.set()
        for task in self.tasks.values():
            task.cancel()
