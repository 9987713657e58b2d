"""Locks: only one sweep at a time writes to a store."""

import contextlib
import fcntl
import os
import shutil
import warnings

from ..errors import StoreError


@contextlib.contextmanager
def exclusive_lock(path, store):
    """Lock this file of a store; the system releases the lock when the process ends or is killed.

    Raises
    ------
    StoreError
        Another sweep has the lock; the file is missing, or may not be written to.
    """
    try:
        handle = os.open(path, os.O_RDWR)
    except OSError as error:
        raise StoreError(
            f"{store} cannot be written to ({error.strerror}); mend its permissions, or copy it "
            f"to where you may write, and run the sweep there; what it holds is whole"
        ) from error
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StoreError(
                f"another sweep is writing to {store}; wait until it has ended, or give this one "
                f"a store of its own"
            ) from None
        except OSError as error:  # some network file systems have no locks
            warnings.warn(
                f"{store} cannot be locked ({error.strerror}): see to it that no other sweep "
                f"writes to it",
                RuntimeWarning,
                stacklevel=4,
            )
        yield
    finally:
        os.close(handle)


def lock_folder(folder):
    """Mark a folder as in use while this process lives; a handle to close afterwards.

    None: another process takes the folder for abandoned and is removing it.
    """
    try:
        handle = os.open(folder, os.O_RDONLY)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        return None
    except OSError:  # some network file systems have no locks; nothing is removed there
        return handle
    if not folder.exists():
        os.close(handle)
        return None
    return handle


def remove_if_abandoned(folder):
    """Remove a folder if the process that marked it is gone."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)  # under the lock, so that nobody starts using it
    except OSError:
        pass
    finally:
        os.close(handle)
