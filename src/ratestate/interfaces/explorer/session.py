"""One page's connection: its questions into lanes, their answers back."""

import asyncio
import contextlib
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from starlette.websockets import WebSocketDisconnect

from ...engine.backend import Stopped
from ...errors import RateStateError
from . import charts, picture, wire
from .budget import Deadline
from .entries import asked_of, fields, prefixes
from .exports import export
from .lane import Lane, answered
from .presets import presets

# Of downloads: how many may wait, and seconds for one, and for each part of its work.
ROOM, SECONDS, PART_SECONDS = 8, 10.0, 2.0
# Seconds that kernels may take until they are there: on some machines they are compiled.
PREPARING = 300.0
# Messages that are no question, one after another, after which a page is shown the door.
NONSENSE, REFUSED = 20, 1008
# Seconds for which a picture is still worth finishing after a newer one is wanted.
PATIENCE = 0.4


class Desk:
    """What all pages share: threads, and whether the kernels are ready."""

    def __init__(self):
        self.pool = ThreadPoolExecutor(2, "explorer")
        self.chart_pool = ThreadPoolExecutor(1, "explorer-chart")
        self.file_pool = ThreadPoolExecutor(1, "explorer-file")
        self.preparing = Deadline(PREPARING)
        self.ready = asyncio.Event()
        self.sessions: set[Session] = set()

    async def warm(self):
        """Do once what pages ask for: that loads the kernels, or compiles them."""
        await asyncio.get_running_loop().run_in_executor(self.pool, _rehearse, self.preparing)
        self.ready.set()
        for session in list(self.sessions):
            await session.send(wire.answer(None, "ready"))

    def close(self):
        """End all work."""
        self.preparing.set()
        for session in self.sessions:
            session.stop()
        for pool in (self.pool, self.chart_pool, self.file_pool):
            pool.shutdown(wait=False, cancel_futures=True)


class Session:
    """A page's connection."""

    def __init__(self, desk, socket):
        self.desk, self.socket, self.sending = desk, socket, asyncio.Lock()
        self.nonsense = 0
        surveys = [partial(survey, size=size) for size in charts.SIZES]
        pictures = Lane(desk.pool, [paint], seconds=picture.SECONDS, patience=PATIENCE)
        maps = Lane(desk.chart_pool, surveys, seconds=charts.SECONDS, patience=0.0)
        files = Lane(desk.file_pool, [write], seconds=PART_SECONDS, whole=SECONDS, room=ROOM)
        self.lanes = {"picture": pictures, "chart": maps}
        self.lanes |= dict.fromkeys(("scenario", "python", "csv"), files)

    async def serve(self):
        """Answer until the page is gone."""
        self.desk.sessions.add(self)
        ready = self.desk.ready
        tasks = [asyncio.create_task(x.work(ready, self.send)) for x in {*self.lanes.values()}]
        try:
            span, line = charts.frame()
            starts = presets()
            usual = asked_of(starts[0]["entries"]).values
            known = {
                "fields": fields(usual),
                "prefixes": prefixes(),
                "presets": starts,
                "span": span,
            }
            await self.send(wire.answer(None, "hello", line, ready=ready.is_set(), **known))
            while (message := await self.socket.receive())["type"] != "websocket.disconnect":
                await self.take(message.get("text") or "")
        except WebSocketDisconnect:
            pass
        finally:
            self.desk.sessions.discard(self)
            self.stop()
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def take(self, text):
        """Put a question into its lane; say at once what is none."""
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
        dropped = self.lanes[question.ask].take(question)
        if dropped and dropped.ask not in ("picture", "chart"):
            problems = {"": "too many downloads were waiting; this one was dropped"}
            await self.send(wire.answer(dropped.id, "problem", problems=problems))

    async def send(self, message):
        """Send an answer, one at a time."""
        async with self.sending:
            await self.socket.send_bytes(message)

    def stop(self):
        """End what is being computed for this page."""
        for lane in self.lanes.values():
            if lane.deadline:
                lane.deadline.set()


def paint(question, deadline):
    """Answer "picture"."""
    header, arrays = picture.picture(asked_of(question.entries), deadline)
    return wire.answer(question.id, "picture", arrays, **header)


def survey(question, deadline, size):
    """Answer "chart", at one size."""
    slider = asked_of(question.entries).slider
    try:
        header, arrays = charts.chart(slider, size, deadline)
    except RateStateError as error:
        return wire.answer(question.id, "problem", problems={"map": str(error)})
    return wire.answer(question.id, "chart", arrays, **header)


def write(question, deadline):
    """Answer a download."""
    return wire.answer(
        question.id, "file", **export(question.ask, asked_of(question.entries), deadline)
    )


def _rehearse(deadline):
    """Every kind of work once, unless it is cancelled."""
    entries = presets()[0]["entries"]
    for law in ("slip", "aging"):
        for job in (paint, partial(survey, size=2)):
            question = wire.Question(0, "picture", entries | {"law": law})
            with contextlib.suppress(Stopped):
                answered(job, question, deadline)
