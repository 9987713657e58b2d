"""The page and its WebSocket."""

import asyncio
import contextlib
from pathlib import Path

from fastapi import FastAPI, WebSocket
from starlette.staticfiles import StaticFiles

from .guard import Guard
from .session import Session, SharedWork

STATIC = Path(__file__).parent / "static"
# Pages open at the same time; of one more the connection is refused ("try again later").
MOST_PAGES, LATER = 8, 1013


def app_of(port):
    """The ASGI application, for a server at this port of 127.0.0.1."""

    @contextlib.asynccontextmanager
    async def lifespan(app):
        app.state.shared = shared = SharedWork()
        warming = asyncio.create_task(shared.warm())
        yield
        shared.close()
        warming.cancel()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)
    app.add_middleware(Guard, port=port)

    @app.websocket("/socket")
    async def socket(socket: WebSocket) -> None:
        shared = socket.app.state.shared
        await socket.accept()
        if len(shared.sessions) >= MOST_PAGES:
            await socket.close(LATER, "too many pages are open; close one")
        else:
            await Session(shared, socket).serve()

    app.mount("/", StaticFiles(directory=STATIC, html=True))
    return app
