"""Connections on which no request comes: closed, so that they do not shut others out."""

import contextlib
import socket
import threading
import time
from http.client import HTTPConnection

import pytest
import uvicorn
from websockets.sync.client import connect

from ratestate_explorer import app as explorer_app


async def app(scope, receive, send):
    """Answer requests with "there", and WebSocket messages with themselves."""
    await receive()
    if scope["type"] == "http":
        await send({"type": "http.response.start", "status": 200})
        await send({"type": "http.response.body", "body": b"there"})
        return
    await send({"type": "websocket.accept"})
    while (message := await receive())["type"] == "websocket.receive":
        await send({"type": "websocket.send", "text": message["text"]})


@pytest.fixture
def port(monkeypatch):
    monkeypatch.setattr(explorer_app, "SECONDS", 0.6)
    how = {
        "http": explorer_app.ImpatientProtocol,
        "ws": "websockets-sansio",
        "lifespan": "off",
    }
    server = uvicorn.Server(uvicorn.Config(app, log_level="warning", **how))
    with socket.create_server(("127.0.0.1", 0)) as listening:
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
        thread.start()
        yield listening.getsockname()[1]
        server.should_exit = True
        thread.join()


@pytest.mark.parametrize("sent", [b"", b"GET / HTTP/1.1\r\nHost: 127."])
def test_a_half_open_connection_is_closed(sent, port):
    with socket.create_connection(("127.0.0.1", port), timeout=20) as half:
        half.sendall(sent)
        start = time.monotonic()
        assert half.recv(1) == b""
        assert time.monotonic() - start > 0.4


def test_a_connection_is_closed_after_a_half_request(port):
    request = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
    with socket.create_connection(("127.0.0.1", port), timeout=20) as half:
        half.sendall(request + b"\r\n" + request)
        answer = b""
        while part := half.recv(1000):
            answer += part
        assert answer.count(b"there") == 1


def test_requests_in_time_and_pages_stay(port):
    with (
        contextlib.closing(HTTPConnection("127.0.0.1", port, timeout=20)) as kept,
        connect(f"ws://127.0.0.1:{port}") as page,
    ):
        for _ in range(4):
            kept.request("GET", "/")
            kept.auto_open = 0  # the same connection from here on
            assert kept.getresponse().read() == b"there"
            time.sleep(0.25)
        page.send("late")
        assert page.recv(timeout=20) == "late"
