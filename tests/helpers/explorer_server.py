"""An explorer in this process, and pages of it."""

import contextlib
import json
import struct
import threading

import numpy as np
from websockets.sync.client import connect

from ratestate_explorer import server


def read(message):
    """Header and arrays of an answer, read by hand."""
    (length,) = struct.unpack_from("<I", message)
    header, at = json.loads(message[4 : 4 + length]), 4 + length
    assert at % 8 == 0
    arrays = {}
    for name, n in header.pop("arrays"):
        arrays[name] = np.frombuffer(message, "<f8", n, at)
        at += 8 * n
    if header["kind"] == "file":
        header["content"] = message[at:]
    else:
        assert at == len(message)
    return header, arrays


@contextlib.contextmanager
def served():
    """The port of an explorer in this process."""
    listening = server.listen(0)
    running = server.server_at(listening)
    thread = threading.Thread(target=running.run, kwargs={"sockets": [listening]})
    thread.start()
    yield listening.getsockname()[1]
    running.should_exit = True
    thread.join(20)
    listening.close()
    assert not thread.is_alive()


@contextlib.contextmanager
def page(port, **more):
    """A page's WebSocket, after its `greeting`."""
    more = {"origin": f"http://127.0.0.1:{port}"} | more
    with connect(f"ws://127.0.0.1:{port}/socket", max_size=None, **more) as socket:
        socket.greeting, _ = read(socket.recv(30))
        assert socket.greeting["kind"] == "hello"
        yield socket
