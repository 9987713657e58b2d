"""The page and its WebSocket, only for browsers on this machine, at the explorer's own address."""

import asyncio
import contextlib
from functools import partial

import h11
from fastapi import FastAPI, WebSocket
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse, Response
from starlette.staticfiles import StaticFiles
from uvicorn.protocols.http.h11_impl import H11Protocol

from .bundle import STATIC, served
from .lab_record import take_record
from .session import Session, SharedWork

# Pages open at the same time; of one more the connection is refused ("try again later").
MOST_PAGES, LATER = 8, 1013
#: names under which the page may be opened
NAMES = ("127.0.0.1", "localhost")
# The port that browsers leave out of Host and Origin.
HTTP = 80
#: seconds in which the headers of a request must come
SECONDS = 10.0
#: headers of every answer: no content of other hosts, no frames but those named, no caching
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors {frames}"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-cache",
}


def app_of(port, frames):
    """Return the ASGI application, for a server at this port of 127.0.0.1.

    frames : the pages that may have it in a frame, as a policy writes them
    """

    @contextlib.asynccontextmanager
    async def lifespan(app):
        app.state.shared = shared = SharedWork()
        warming = asyncio.create_task(shared.warm())
        yield
        shared.close()
        warming.cancel()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)
    app.add_middleware(Guard, port=port, frames=frames)

    @app.websocket("/socket")
    async def socket(socket: WebSocket) -> None:
        shared = socket.app.state.shared
        await socket.accept()
        if len(shared.sessions) >= MOST_PAGES:
            await socket.close(LATER, "too many pages are open: close one")
        else:
            await Session(shared, socket).serve()

    app.add_route("/record", take_record, methods=["POST"])
    for path, of_page in served().items():
        app.add_route(path, partial(_part, *of_page))
    app.mount("/", StaticFiles(directory=STATIC, html=True))
    return app


async def _part(text, kind, _request):
    return Response(text, media_type=kind)


class Guard:
    """ASGI middleware that refuses other hosts' names and origins.

    The header Host must be the explorer's own, and so must Origin, which a WebSocket and a POST
    must have.  This refuses names of other hosts that resolve to this machine, and pages of other
    hosts that send requests here.
    """

    def __init__(self, app, port, frames="'none'"):
        self.app = app
        self.added = {name: text.format(frames=frames) for name, text in HEADERS.items()}
        hosts = {f"{name}:{port}" for name in NAMES}
        self.hosts = hosts | set(NAMES) if port == HTTP else hosts
        self.origins = {f"http://{host}" for host in self.hosts}

    async def __call__(self, scope, receive, send):
        async def send_with_headers(message):
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(self.added)
            await send(message)

        if scope["type"] == "lifespan" or self._is_own(scope):
            await self.app(scope, receive, send_with_headers)
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        else:
            refusal = PlainTextResponse("not this host's page", 403)
            await refusal(scope, receive, send_with_headers)

    def _is_own(self, scope):
        headers = Headers(scope=scope)
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        own_origin = all(origin in self.origins for origin in origins)
        if scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD"):
            own_origin = own_origin and len(origins) == 1
        return len(hosts) == 1 and hosts[0] in self.hosts and own_origin


class ImpatientProtocol(H11Protocol):
    """uvicorn's HTTP/1.1, which closes a connection if no request has come in `SECONDS`.

    Otherwise half-open connections could take all files that the process may open.
    """

    timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport):
        """Begin to wait for the first request."""
        super().connection_made(transport)
        self._wait()

    def on_response_complete(self):
        """Begin to wait for the next request."""
        super().on_response_complete()
        self._wait()

    def _wait(self):
        if self.timer:
            self.timer.cancel()
        self.timer = self.loop.call_later(SECONDS, self._close_if_waiting)

    def _close_if_waiting(self):
        if self.conn.their_state is h11.IDLE:  # no headers have come
            self.transport.close()
