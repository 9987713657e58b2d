"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

================== ===========================================================================
``server``         port, address, browser, end
``app``            page and WebSocket, for this machine's browser only; how many pages
``session``        one page's questions into queues, the answers back
``question_queue`` questions of one kind in order, with a time limit each; the oldest drop out
``kernels``        kernels of each law, form of friction, ..., loaded before the first answer
``wire``           which questions are valid; questions and answers as bytes
``budget``         the time limit of a question
``entries``        from typed entries to a slider and speeds, and back
``menus``          what there is to choose: fields, laws, the paper's sliders
``motion``         which run is shown, and for how long
``picture``        what is drawn: run, limit cycle, steady point, verdict
``charts``         what is behind the map: K_c, and the atlas; which sliders share them
``exports``        scenario file, Python lines, CSV
``static``         the page
================== ===========================================================================
"""

from .entries import fragment_of
from .server import serve

__all__ = ["fragment_of", "serve"]
