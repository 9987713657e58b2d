"""One page's connection: its questions go into queues, the answers back.

`answer_picture`, `answer_chart` and `answer_file` compute what is wanted.
"""

import asyncio
import contextlib
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from starlette.websockets import WebSocketDisconnect

from ...engine.backend import Stopped
from ...errors import RateStateError
from ...friction.laws import ONE_LENGTH
from . import charts, picture, wire
from .budget import Deadline
from .entries import fields, prefixes, presets, state_of
from .exports import NAMES, export
from .question_queue import QuestionQueue, run_job

# Downloads: how many may wait; seconds for one, and for each part of its work.
CAPACITY, SECONDS, PART_SECONDS = 8, 10.0, 2.0
# Seconds that loading the kernels may take: on some machines they are compiled.
PREPARING = 300.0
# After so many invalid messages in a row the connection is closed.
NONSENSE, REFUSED = 20, 1008
# Seconds for which a picture is still computed after a newer one is requested.
PATIENCE = 0.4


class SharedWork:
    """Shared by all pages: threads, and whether the kernels are ready."""

    def __init__(self):
        self.pool = ThreadPoolExecutor(2, "explorer")
        self.chart_pool = ThreadPoolExecutor(1, "explorer-chart")
        self.file_pool = ThreadPoolExecutor(1, "explorer-file")
        self.preparing = Deadline(PREPARING)
        self.ready = asyncio.Event()
        self.sessions: set[Session] = set()

    async def warm(self):
        """Load the kernels, or compile them, by doing once what pages ask for."""
        await asyncio.get_running_loop().run_in_executor(self.pool, _warm_up, self.preparing)
        self.ready.set()
        greetings = (session.send(wire.answer(None, "ready")) for session in self.sessions)
        await asyncio.gather(*greetings, return_exceptions=True)  # a page may be gone by then

    def close(self):
        """End all work."""
        self.preparing.set()
        for session in self.sessions:
            session.stop()
        for pool in (self.pool, self.chart_pool, self.file_pool):
            pool.shutdown(wait=False, cancel_futures=True)


class Session:
    """A page's connection."""

    def __init__(self, shared, socket):
        self.shared, self.socket, self.send_lock = shared, socket, asyncio.Lock()
        self.nonsense = 0
        surveys = [partial(answer_chart, size=size) for size in charts.SIZES]
        pictures = QuestionQueue(
            shared.pool, [answer_picture], seconds=picture.SECONDS, patience=PATIENCE
        )
        maps = QuestionQueue(shared.chart_pool, surveys, seconds=charts.SECONDS, patience=0.0)
        files = QuestionQueue(
            shared.file_pool, [answer_file], seconds=PART_SECONDS, whole=SECONDS, capacity=CAPACITY
        )
        self.queues = {"picture": pictures, "chart": maps, **dict.fromkeys(NAMES, files)}

    async def serve(self):
        """Answer until the page is gone."""
        self.shared.sessions.add(self)
        ready = self.shared.ready
        tasks = [asyncio.create_task(x.work(ready, self.send)) for x in {*self.queues.values()}]
        try:
            await self.send(_greeting(ready.is_set()))
            while (message := await self.socket.receive())["type"] != "websocket.disconnect":
                await self.take(message.get("text") or "")
        except WebSocketDisconnect:
            pass
        finally:
            self.shared.sessions.discard(self)
            self.stop()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def take(self, text):
        """Put a question into its queue; answer an invalid message with its problem."""
        try:
            question = wire.question(text)
        except wire.BadQuestion as error:
            await self.send(wire.answer(None, "problem", problems={"": str(error)}))
            self.nonsense += 1
            if self.nonsense >= NONSENSE:
                await self.socket.close(REFUSED, "these are no questions")
                raise WebSocketDisconnect(REFUSED) from None
            return
        self.nonsense = 0
        dropped = self.queues[question.ask].take(question)
        if dropped and dropped.ask not in ("picture", "chart"):
            problems = {"": "too many downloads were waiting; this one was dropped"}
            await self.send(wire.answer(dropped.id, "problem", problems=problems))

    async def send(self, message):
        """Send an answer, one at a time."""
        async with self.send_lock:
            await self.socket.send_bytes(message)

    def stop(self):
        """Stop what is being computed for this page."""
        for queue in self.queues.values():
            queue.deadline.set()


def _greeting(ready):
    """The message to a page that was opened."""
    (span, line), starts = charts.frame(), presets()
    usual = fields(state_of(starts[0]["entries"]).values)
    header = {"fields": usual, "laws": [*ONE_LENGTH], "prefixes": prefixes(), "presets": starts}
    return wire.answer(None, "hello", line, ready=ready, span=span, **header)


def answer_picture(question, deadline):
    """Answer "picture"."""
    header, arrays = picture.picture(state_of(question.entries), deadline)
    return wire.answer(question.id, "picture", arrays, **header)


def answer_chart(question, deadline, size):
    """Answer "chart" at one size."""
    slider = state_of(question.entries).slider
    try:
        header, arrays = charts.chart(slider, size, deadline)
    except RateStateError as error:
        return wire.answer(question.id, "problem", problems={"map": str(error)})
    return wire.answer(question.id, "chart", arrays, **header)


def answer_file(question, deadline):
    """Answer a download."""
    text = export(question.ask, state_of(question.entries), deadline)
    return wire.answer(question.id, "file", **text)


def _warm_up(deadline):
    """Do every kind of work once, unless cancelled."""
    entries = presets()[0]["entries"]
    for law in ONE_LENGTH:
        for job in (answer_picture, partial(answer_chart, size=2)):
            question = wire.Question(0, "picture", entries | {"law": law})
            with contextlib.suppress(Stopped):
                run_job(job, question, deadline)
