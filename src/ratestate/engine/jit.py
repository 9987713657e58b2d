"""How the kernels are compiled.

Contraction (a*b + c in one rounding) is the only liberty taken: numbers are never assumed finite,
nor sums associative.  What compiled code alone calls goes without all that only Python would need
(pipeline.py); compiling takes half as long.
"""

import functools
import inspect
from typing import Any

import numba
from numba import njit
from numba.extending import overload

from .cache import KernelCache

_overload: Any = overload  # (its declared arguments lack jit_options)


def _compiler():
    """The option of compiling by `InnerCompiler`, where numba has the parts that this takes."""
    if not numba.__version__.startswith("0.68."):
        return {}
    from .pipeline import InnerCompiler

    return {"pipeline_class": InnerCompiler}


_BARE: Any = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_INNER: Any = _BARE | _compiler()
#: methods of laws, whose source may be a user's
LAW_METHODS: Any = {"forceinline": True, "fastmath": {"contract"}, **_BARE}
INLINED: Any = LAW_METHODS | _INNER

#: arithmetic that must end up inside a vectorised loop
inlined = njit(**INLINED)
#: loops over lanes
lanewise = njit(fastmath={"contract"}, **_INNER)
#: scalar code between them
inner = njit(**_INNER)


def recursive(function):
    """A function that calls itself for shorter, or longer, tuples: it is inlined for each length.

    (By `njit` alone, numba takes such a call for one of the very function it is compiling.)
    """

    @_overload(function, jit_options=INLINED)
    @functools.wraps(function)  # numba compares the arguments
    def of_types(*arguments):
        return function

    return function


def unrolled(lines):
    """A function of tuples that is written out for their lengths, and inlined.

    lines : the function, its arguments -> the lines of its body, which depend on lengths alone
    """
    name, arguments = lines.__name__, ", ".join(inspect.signature(lines).parameters)

    def written_out(*given):
        scope: dict[str, Any] = {}
        body = "\n    ".join([f"def {name}({arguments}):", *lines(*given)])
        exec(body, lines.__globals__, scope)
        return scope[name]

    @functools.wraps(lines)
    def plain(*given):
        return written_out(*given)(*given)

    @_overload(plain, jit_options=INLINED)
    @functools.wraps(lines)  # numba compares the arguments
    def of_types(*given):
        return written_out(*given)

    return plain


def kernel(function, name=None):
    """What Python calls: compiled, and kept on disk; unchanged where the compiler is off.

    name : by which it is kept, if it is not the function's
    """
    compiled: Any = njit(nogil=True, error_model="numpy")(function)
    if compiled is not function:  # where the compiler is off it is
        compiled._cache = KernelCache(function, name or function.__qualname__)
    return compiled
