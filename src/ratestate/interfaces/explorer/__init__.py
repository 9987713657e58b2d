"""The explorer: a page on this machine that shows what a slider does while its parameters move.

::

    server.py    port, address, browser, end
    app.py       page and WebSocket, for this machine's browser only
    guard.py     who may come
    session.py   one page's questions into lanes, the answers back
    lane.py      questions of one kind, the newest first, each bounded in time
    wire.py      questions and answers as bytes
    budget.py    what one question may cost
    entries.py   from what is typed to a slider
    motion.py    which run is shown, and for how long
    picture.py   what is drawn: run, limit cycle, steady point, verdict
    charts.py    the atlas behind the map
    exports.py   scenario file, Python lines, CSV
    presets.py   the paper's sliders
    static/      the page
"""

from .presets import fragment_of
from .server import serve

__all__ = ["fragment_of", "serve"]
