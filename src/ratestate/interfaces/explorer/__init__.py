"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

================== ===========================================================================
``server``         port, address, browser, end
``app``            page and WebSocket, for this machine's browser only; how many pages
``session``        one page's questions into queues, the answers back
``question_queue`` questions of one kind in order, with a time limit each; the oldest drop out
``kernels``        kernels of each law, form of friction, ..., loaded before the first answer
``wire``           which questions are valid; questions and answers as bytes
``budget``         the time limit of a question
``typed``          a typed text as a value
``protocol``       the segments of a protocol, as text and back
``state``          a slider, speeds and an experiment
``entries``        from typed entries to such a state, and back
``menus``          what there is to choose: fields, laws, the paper's sliders
``meanings``       what its symbols mean, for readers new to them
``motion``         which run is shown, and for how long
``settled``        the motion that has settled before an experiment
``experiment``     which run shows an experiment
``picture``        what is drawn: run, limit cycle, steady point, verdict
``marks``          the critical values on its sliders
``charts``         what is behind the map: K_c, the atlas, finer parts; which sliders share them
``branch``         the bifurcation diagram: its range, stability, and branches of limit cycles
``answers``        these as answers, each to its question
``exports``        files to take along: scenario, Python lines, CSV, and the two that follow
``figure``         a figure for a paper
``standalone``     the page as one file, with what it shows: `bundle` puts its own files into one
``address``        where the page is found
``notebook``       the page in a notebook: the function `explore`
``decimation``     which points of a long curve are sent
``record``         a laboratory's record: what is drawn of it, what there is to choose
``upload``         the file of such a record, from the page into memory
``static``         the page
================== ===========================================================================
"""

from .entries import fragment_of
from .server import serve

__all__ = ["fragment_of", "serve"]
