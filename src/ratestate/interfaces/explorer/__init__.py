"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

::

    server.py          port, address, browser, end
    app.py             page and WebSocket, for this machine's browser only
    session.py         one page's questions into queues, the answers back
    question_queue.py  questions of one kind in order, with a time limit each; the oldest drop out
    wire.py            questions and answers as bytes
    budget.py          the time limit of a question
    entries.py         from typed entries to a slider, and back; the paper's sliders
    motion.py          which run is shown, and for how long
    picture.py         what is drawn: run, limit cycle, steady point, verdict
    charts.py          the atlas behind the map
    exports.py         scenario file, Python lines, CSV
    static/            the page
"""

from .entries import fragment_of
from .server import serve

__all__ = ["fragment_of", "serve"]
