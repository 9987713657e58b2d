"""One sweep at a time writes to a store."""

import contextlib
import fcntl
import os
import warnings

from ..errors import StoreError


@contextlib.contextmanager
def alone(path, store):
    """Hold this file of a store, so that no other sweep does; given up even by a killed process.

    Raises
    ------
    StoreError
        Another sweep holds it; it may not be written to; it is missing.
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
        except OSError as error:  # some network file systems know no locks
            warnings.warn(
                f"{store} cannot be locked ({error.strerror}): see to it that no other sweep "
                f"writes to it",
                RuntimeWarning,
                stacklevel=4,
            )
        yield
    finally:
        os.close(handle)


def hold(folder):
    """Mark a folder as in use, for as long as this process lives; a handle to close afterwards."""
    handle = os.open(folder, os.O_RDONLY)
    with contextlib.suppress(OSError):
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return handle


def abandoned(folder):
    """Whether the process that marked this folder is gone."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    finally:
        os.close(handle)
    return True
