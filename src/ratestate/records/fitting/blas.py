"""One thread for small matrices: more of them spin longer than they work."""

import functools

from threadpoolctl import ThreadpoolController


@functools.cache
def _controller():
    return ThreadpoolController()


def single_blas():
    """A context in which BLAS uses one thread."""
    return _controller().limit(limits=1, user_api="blas")
