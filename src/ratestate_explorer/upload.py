"""The file of a laboratory record that a page sends: taken into memory, read, forgotten."""

import asyncio
import contextlib

from starlette.requests import ClientDisconnect
from starlette.responses import Response

from . import wire
from .record import answer_record, choices_of

#: bytes of a file, and seconds in which it must be here
LARGEST, SECONDS = 50_000_000, 60.0


class Refused(Exception):
    """A file that is not read; status: that of the answer."""

    def __init__(self, status, problem):
        super().__init__(problem)
        self.status = status


async def take_record(request):
    """Answer a POST of a file, whose query has `page`, `name` and perhaps `choices`.

    ``page`` is the token that the page was greeted with; ``choices`` is a JSON object.  Of a page's
    files the newest is read: an earlier one, and that of a page that has gone, is given up.
    """
    try:
        session = _session(request)
        choices = choices_of(request.query_params.get("choices", "{}"))
        _check_length(request)
        stop = session.begin_record()
        contents = await _contents(request, stop)
    except Refused as refused:
        return _response(wire.answer(None, "record", problem=str(refused)), refused.status)
    except wire.BadQuestion as error:
        return _response(wire.answer(None, "record", problem=str(error)), 400)
    except ClientDisconnect:
        return Response(status_code=400)
    name = request.query_params.get("name", "")
    work = asyncio.get_running_loop().run_in_executor(
        session.shared.record_pool, answer_record, name, contents, choices, stop
    )
    del contents
    return _response(await _unless_gone(request, work, stop), 200)


def _session(request):
    """Return the connection of the page that sends."""
    page = request.query_params.get("page", "")
    for session in request.app.state.shared.sessions:
        if session.token == page:
            return session
    raise Refused(403, "this page is not connected to ratestate; wait until it is, and try again")


def _check_length(request):
    """Refuse a file that says it is too large."""
    length = request.headers.get("content-length", "0")
    if not length.isdecimal() or int(length[:20]) > LARGEST:
        raise Refused(413, too_large())


async def _contents(request, stop):
    """Return the bytes of the file; Refused if it is not wanted any more."""
    contents = bytearray()
    try:
        async with asyncio.timeout(SECONDS):
            async for chunk in request.stream():
                contents += chunk
                if stop.is_set():
                    raise Refused(409, "another file was sent after this one, or its page has gone")
                if len(contents) > LARGEST:
                    raise Refused(413, too_large())
    except TimeoutError:
        raise Refused(408, f"the file did not arrive within {SECONDS:g} s; try again") from None
    return bytes(contents)


def too_large():
    """Return the message for a file that is too large."""
    return (
        f"the file is larger than the {LARGEST / 1e6:g} MB that the page takes; leave out what is "
        f"not of interest, or take every tenth row; read_lab in Python has no such limit"
    )


async def _unless_gone(request, work, stop):
    """Return the result of work, which is stopped if the page does not wait for it any more."""

    async def gone():
        while (await request.receive())["type"] != "http.disconnect":
            pass
        stop.set()

    watch = asyncio.create_task(gone())
    try:
        return await work
    finally:
        watch.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await watch


def _response(message, status):
    return Response(message, status, media_type="application/octet-stream")
