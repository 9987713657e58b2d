"""Compiled code only: no xarray, no units, no files.

numba's cache on disk looks at the time stamp of the one file that holds a cached function, so it
goes stale when a function in another file changes.  The kernels here are therefore cached in a
folder named by a hash of all their sources: other sources, other folder.
"""

import contextlib
import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any

from numba import config as numba_config

config: Any = numba_config  # numba sets its attributes at run time


def _digest():
    """A hash of all sources of the kernels."""
    here = Path(__file__).parent
    sources = [here.parent / "laws.py", *sorted(here.glob("*.py"))]
    return hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:16]


def _cache_folder(digest):
    """The folder for these sources, or a temporary one where the usual place is read-only."""
    base = config.CACHE_DIR or os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(base) / "ratestate" / f"kernels-{digest}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except OSError:
        pass
    return Path(tempfile.mkdtemp(prefix="ratestate-kernels-"))


@contextlib.contextmanager
def _cached_in(folder):
    """Let functions decorated inside cache in this folder; others keep their own place."""
    before = config.CACHE_DIR
    config.CACHE_DIR = str(folder)
    try:
        yield
    finally:
        config.CACHE_DIR = before


DIGEST = _digest()
CACHE = _cache_folder(DIGEST)

with _cached_in(CACHE):
    # importing is what binds their caches
    from . import march as _march  # noqa: F401
    from . import noise as _noise  # noqa: F401
    from . import return_map as _return_map  # noqa: F401
