"""Serve the page: port, address, browser, end."""

import errno
import socket
import sys
import threading
import webbrowser

import ratestate as rs

from .entries import PORT, address_of
from .wire import LONGEST

# Most characters of a message, or the connection is closed; seconds that pages have to end.
LARGEST, PATIENCE = 2 * LONGEST, 2


def serve(port=None, open_browser=True, fragment=""):
    """Serve the explorer on 127.0.0.1 until Ctrl-C, whose KeyboardInterrupt is raised in the end.

    Without a port it is 8765 or, where that is in use, any that is free.  The page opens with the
    `fragment` of its address (see `entries.fragment_of`).
    """
    listening = listen(port)
    address = address_of(listening.getsockname()[1], fragment)
    sys.stdout.write(f"explorer at {address} (Ctrl-C ends it)\n")
    sys.stdout.flush()
    if open_browser:
        threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()
    server = server_at(listening)
    with listening:
        server.run(sockets=[listening])
    if server.started:  # nothing else ends it; the interrupt came where Python drops exceptions
        raise KeyboardInterrupt


def server_at(listening, frames="'none'"):
    """Return the server of the page, for a listening socket; frames : as for `app.app_of`."""
    import uvicorn

    from .app import ImpatientProtocol, app_of

    config = uvicorn.Config(
        app_of(listening.getsockname()[1], frames),
        log_level="warning",
        http=ImpatientProtocol,
        ws="websockets-sansio",
        ws_max_size=LARGEST,
        ws_per_message_deflate=False,  # compression takes longer than it saves
        timeout_graceful_shutdown=PATIENCE,
        server_header=False,
    )
    return uvicorn.Server(config)


def listen(port=None):
    """Open a socket that listens on this port of 127.0.0.1; ParameterError where it cannot."""
    if port is not None and (type(port) is not int or not 0 <= port <= 65535):
        raise rs.ParameterError(
            f"port = {port!r} must be a whole number from 0 to 65535, such as {PORT}"
        )
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    if sys.platform != "win32":  # on Windows it would let two servers share a port
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind(("127.0.0.1", PORT if port is None else port))
        listening.listen()
    except OSError as error:
        listening.close()
        if port is None:
            return listen(0)
        in_use = error.errno == errno.EADDRINUSE
        problem = "is in use" if in_use else f"cannot be used: {error.strerror}"
        raise rs.ParameterError(
            f"port = {port} {problem}. Give another port, or none: the explorer then chooses one."
        ) from None
    return listening
