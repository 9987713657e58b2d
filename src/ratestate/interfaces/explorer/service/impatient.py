"""HTTP on which a request must come whole, and soon."""

import asyncio

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

#: seconds for the headers of a request
SECONDS = 10.0


class ImpatientProtocol(H11Protocol):
    """uvicorn's HTTP/1.1, which closes a connection if no request has come in `SECONDS`.

    Half-open ones would else take all files that the process may open, and nobody could connect.
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
