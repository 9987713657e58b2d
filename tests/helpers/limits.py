"""Limits of the operating system, for a while."""

import contextlib
import resource


@contextlib.contextmanager
def largest_file(size):
    """Files cannot grow beyond this size [bytes]."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
