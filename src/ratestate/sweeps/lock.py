"""Locks: only one sweep at a time writes to a store, and makes one in a folder.

A file system without locks is warned of, and trusted.
"""

import contextlib
import fcntl
import os
import shutil
import warnings

from ..errors import StoreError
from . import sentence


@contextlib.contextmanager
def exclusive_lock(path, store):
    """Context manager: locks the file at `path`; the system unlocks it if the process is killed.

    StoreError, which names the store, if another sweep has the lock, or the file is missing or may
    not be written to.
    """
    try:
        handle = os.open(path, os.O_RDWR)
    except OSError as error:
        message = sentence("store.unwritable", path=store, error=error.strerror)
        raise StoreError(message) from error
    try:
        try:
            _lock(handle)
        except BlockingIOError:
            raise StoreError(sentence("store.in_use", path=store)) from None
        except OSError as error:  # some network file systems have no locks
            message = sentence("store.no_lock", path=store, error=error.strerror)
            warnings.warn(message, RuntimeWarning, stacklevel=4)
        yield
    finally:
        os.close(handle)


def lock_folder(folder):
    """Mark a folder as in use while this process lives; a handle (int) to close afterwards.

    None: the folder is not there, or another process takes it for abandoned and is removing it.
    """
    try:
        handle = os.open(folder, os.O_RDONLY)
    except FileNotFoundError:
        return None
    try:
        _lock(handle)
        removed = not folder.exists()
    except BlockingIOError:
        removed = True
    except OSError:  # some network file systems have no locks; nothing is removed there
        removed = False
    if not removed:
        return handle
    os.close(handle)
    return None


def remove_if_abandoned(folder):
    """Remove a folder if the process that marked it is gone; nothing where that fails."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            _lock(handle)
            shutil.rmtree(folder, ignore_errors=True)  # under the lock: nobody starts using it
        finally:
            os.close(handle)


def _lock(handle):
    """Lock an open file or folder; BlockingIOError if another process has the lock."""
    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
