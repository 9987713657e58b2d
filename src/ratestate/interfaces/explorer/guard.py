"""Access to the explorer: only for this machine's browser, at the explorer's own address."""

from starlette.responses import PlainTextResponse

#: names under which the page may be opened
NAMES = ("127.0.0.1", "localhost")
# The port that browsers leave out of Host and Origin.
HTTP = 80
#: headers of every answer: no content of other hosts, no frames, no caching
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-cache",
}


class Guard:
    """ASGI middleware that refuses other hosts' names and origins.

    The header Host, and for a WebSocket Origin, must be the explorer's own.  This refuses names of
    other hosts that resolve to this machine, and pages of other hosts that send requests here.
    """

    def __init__(self, app, port):
        self.app = app
        hosts = {f"{name}:{port}" for name in NAMES}
        self.hosts = {host.encode() for host in (hosts | set(NAMES) if port == HTTP else hosts)}
        self.origins = {b"http://" + host for host in self.hosts}

    async def __call__(self, scope, receive, send):
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        headers = scope["headers"]
        hosts = [value for name, value in headers if name == b"host"]
        origins = [value for name, value in headers if name == b"origin"]
        own_host = len(hosts) == 1 and hosts[0] in self.hosts
        own_origin = all(origin in self.origins for origin in origins)
        if scope["type"] == "websocket":
            own_origin = own_origin and len(origins) == 1
        if own_host and own_origin:
            await self.app(scope, receive, self._with_headers(scope, send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        else:
            refusal = PlainTextResponse("not this host's page", 403)
            await refusal(scope, receive, self._with_headers(scope, send))

    def _with_headers(self, scope, send):
        """`send`, with `HEADERS` in every HTTP answer."""
        if scope["type"] != "http":
            return send

        async def wrapped(message):
            if message["type"] == "http.response.start":
                extra = [(k.lower().encode(), v.encode()) for k, v in HEADERS.items()]
                taken = {name for name, _ in extra}
                kept = [pair for pair in message["headers"] if pair[0].lower() not in taken]
                message = message | {"headers": [*kept, *extra]}
            await send(message)

        return wrapped
