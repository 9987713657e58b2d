"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

============== ===========================================================================
``state``      typed texts as values; the state of the page: a slider and an experiment
``entries``    from the page's entries to such a state, and back; the page's address
``deadline``   the time limit of a question
``motion``     which run is shown, and for how long; the motion that has settled before
``experiment`` which run shows an experiment
``charts``     the map of regimes: K_c and the atlas
``picture``    run, limit cycle, steady point, verdict, critical values
``branch``     the bifurcation diagram: its range, stability, and branches of limit cycles
``wire``       which questions are valid; questions and answers as bytes
``answers``    each answer to its question; the problem of a job that fails
``menus``      what the page offers: fields, laws, the paper's sliders, meanings of symbols
``record``     the answer to a laboratory record
``upload``     the file of a laboratory record, from the page into memory
``bundle``     the page's own files as one
``standalone`` the page as that file, with the answers that it shows
``figure``     a figure for a paper
``exports``    files to take along
``queues``     questions in order, the oldest drop out; kernels loaded before the first answer
``session``    one page's questions into queues, the answers back
``app``        page and WebSocket, for this machine's browser only
``server``     port, address, browser, end
``notebook``   the page in a notebook or as a file
``static``     the page
============== ===========================================================================

It needs the extra `explorer`, and uses only the public functions of `ratestate`.
"""

from .entries import fragment_of
from .menus import presets
from .notebook import Page
from .server import serve
from .standalone import save_page

__all__ = ["Page", "fragment_of", "presets", "save_page", "serve"]
