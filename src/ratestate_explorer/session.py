"""The connection of one page: its questions go into queues, the answers go back."""

import asyncio
import secrets
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from starlette.websockets import WebSocketDisconnect

from . import branch, charts, lab_record, picture, wire
from .answers import answer_branch, answer_chart, answer_picture, answer_rows, run_job
from .deadline import Deadline
from .entries import BadEntries, state_of
from .exports import answer_file
from .menus import example, page_data, presets
from .queues import Kernels, QuestionQueue, kind_of

# Downloads: how many may wait; seconds for one, and for each part of its work.
CAPACITY, SECONDS, PART_SECONDS = 8, 10.0, 2.0
# The same for a saved page, which has three bifurcation diagrams in it.
PAGE_SECONDS, PAGE_PART_SECONDS = 90.0, branch.SECONDS
# After so many invalid messages in a row the connection is closed.
NONSENSE, REFUSED = 20, 1008
# Seconds for which a picture is still computed after a newer one is requested.
PATIENCE = 0.4


class SharedWork:
    """Shared by all pages: threads, and the kernels."""

    def __init__(self):
        self.pool = ThreadPoolExecutor(2, "explorer")
        self.chart_pool = ThreadPoolExecutor(1, "explorer-chart")
        self.file_pool = ThreadPoolExecutor(1, "explorer-file")
        self.record_pool = ThreadPoolExecutor(1, "explorer-record")
        self.kernels = Kernels(self.pool, warm_up)
        self.sessions: set[Session] = set()

    async def warm(self):
        """Prepare what the presets need."""
        for kind in dict.fromkeys(kind_of(state_of(preset["entries"])) for preset in presets()):
            await self.kernels.prepare(kind)

    def close(self):
        """End all work."""
        self.kernels.close()
        for session in self.sessions:
            session.stop()
        for pool in (self.pool, self.chart_pool, self.file_pool, self.record_pool):
            pool.shutdown(wait=False, cancel_futures=True)


class Session:
    """A page's connection."""

    def __init__(self, shared, socket):
        self.shared, self.socket, self.send_lock = shared, socket, asyncio.Lock()
        self.nonsense = 0
        self.token = secrets.token_urlsafe(16)  # names the page when it sends a file
        self.record_stop = Deadline(lab_record.FITTING_SECONDS)  # of the record that is being read
        surveys = [partial(answer_chart, size=size) for size in charts.SIZES]
        in_pool = partial(QuestionQueue, shared.pool, seconds=picture.SECONDS)
        of_charts = partial(QuestionQueue, shared.chart_pool, seconds=charts.SECONDS, patience=0.0)
        of_files = partial(QuestionQueue, shared.file_pool, [answer_file], capacity=CAPACITY)
        self.queues = dict.fromkeys(wire.FILES, of_files(seconds=PART_SECONDS, total=SECONDS)) | {
            "picture": in_pool([answer_picture], patience=PATIENCE),
            "slide-hold-slide": in_pool([answer_rows]),
            "chart": of_charts(surveys),
            "window": of_charts([answer_chart]),
            "branch": of_charts([answer_branch], seconds=branch.SECONDS),
            "page": of_files(seconds=PAGE_PART_SECONDS, total=PAGE_SECONDS),
        }

    async def serve(self):
        """Answer until the page is gone."""
        self.shared.sessions.add(self)
        queues = {*self.queues.values()}
        tasks = [asyncio.create_task(queue.work(self.prepare, self.send)) for queue in queues]
        try:
            header = {"page": self.token, "largest_file": lab_record.LARGEST}
            header |= {"too_large": lab_record.too_large(), **page_data(presets())}
            await self.send(wire.answer(None, "hello", **header))
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

    async def prepare(self, question):
        """Wait for the kernels that a question needs, and tell the page so."""
        kernels = self.shared.kernels
        try:
            kinds = {kind_of(state_of(texts)) for texts in (question.entries, *question.pinned)}
        except BadEntries:
            return  # the answer says why
        for kind in kinds:
            if not kernels.are_ready(kind):
                await self.send(wire.answer(None, "preparing"))
                await kernels.prepare(kind)
                await self.send(wire.answer(None, "ready"))

    async def take(self, text):
        """Put a question into its queue; answer an invalid message with its problem."""
        try:
            question = wire.checked(wire.Question, text)
        except wire.BadQuestion as error:
            await self.send(wire.answer(None, "problem", problems={"": str(error)}))
            self.nonsense += 1
            if self.nonsense >= NONSENSE:
                await self.socket.close(REFUSED, "these are not questions")
                raise WebSocketDisconnect(REFUSED) from None
            return
        self.nonsense = 0
        dropped = self.queues[question.ask].take(question)
        if dropped and dropped.ask in wire.FILES:
            problems = {"": "too many downloads were waiting, so this one was cancelled"}
            await self.send(wire.answer(dropped.id, "problem", problems=problems))

    async def send(self, message):
        """Send an answer, one at a time."""
        async with self.send_lock:
            await self.socket.send_bytes(message)

    def stop(self):
        """Stop what is being computed for this page."""
        for queue in self.queues.values():
            queue.deadline.set()
        self.record_stop.set()

    def begin_record(self):
        """Stop reading an earlier record; return the `Deadline` that stops a new one."""
        self.record_stop.set()
        self.record_stop = Deadline(lab_record.FITTING_SECONDS)
        return self.record_stop


def warm_up(kind, deadline):
    """Do all work once for a `Kind`; `Stopped` if it was cancelled."""
    entries = presets()[0]["entries"] | {symbol: example(symbol) for symbol in kind.symbols}
    entries |= {"law": kind.law, "friction_form": kind.friction_form}
    if kind.sigma_varies:
        entries["sigma_from"] = example("sigma")
    question = wire.Question(0, "picture", entries)
    for job in (answer_picture, partial(answer_chart, size=2)):
        run_job(job, question, deadline)
