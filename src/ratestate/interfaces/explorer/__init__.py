"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

=============== ===========================================================================
``page_state``  what the page's entries describe: a slider, speeds and an experiment
``computation`` what is computed for that
``messages``    questions of the page and the answers to them, as bytes
``sharing``     files to take along, among them the page itself
``service``     the server: pages, their questions, time limits
``notebook``    the page in a notebook: the function `explore`
``static``      the page
=============== ===========================================================================
"""

from .page_state.entries import fragment_of
from .service.server import serve

__all__ = ["fragment_of", "serve"]
