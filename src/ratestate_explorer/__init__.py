"""The explorer: a page on this machine that shows the motion of a slider while parameters change.

`app` and `server` serve the page; `session` takes its questions and sends the answers, which
`answers` finds; `wire` has the form of both.  It needs the extra `explorer`, and uses only the
public functions of `ratestate`.
"""

from .entries import fragment_of
from .exports import save_page
from .menus import presets
from .notebook import Page
from .server import serve

__all__ = ["Page", "fragment_of", "presets", "save_page", "serve"]
