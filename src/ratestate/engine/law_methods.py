"""Laws inside compiled code: a type for each, its methods, and the rows that it needs.

numba knows a law by its type, and so compiles for each law a kernel with that law's formulas in it.
"""

import functools
import inspect
from typing import Any

from numba import types
from numba.core.imputils import lower_constant
from numba.extending import (
    NativeValue,
    models,
    overload,
    overload_method,
    register_model,
    typeof_impl,
    unbox,
)

from ..friction.law import FrictionLaw
from . import functions  # noqa: F401  (which methods of laws call)
from .jit import LAW_METHODS
from .rows import rows_of

_inlined: Any = {"jit_options": LAW_METHODS}  # (which the decorators do not declare)


class LawType(types.Type):
    """The type of a law, which is all that compiled code knows of it: it has no value."""

    def __init__(self, law):
        super().__init__(f"{type(law).__module__}.{type(law).__qualname__} {law.name}")
        self.law = law
        for kind in type(law).__mro__[:-1]:
            _overload_methods(kind)


@functools.cache
def _overload_methods(kind):
    """Let compiled code call the methods that a class of laws has, and its bases have not."""
    known = set().union(*(vars(base) for base in kind.__mro__[1:]))
    for name, method in vars(kind).items():
        if inspect.isfunction(method) and name not in known:
            _overload_method(kind, name, method)


def _overload_method(kind, name, method):
    @overload_method(LawType, name, **_inlined)
    @functools.wraps(method)  # numba compares the arguments
    def of_law(self, *arguments):
        """The function that ``law.name(...)`` is in compiled code, for the GPU too."""
        return getattr(type(self.law), name) if isinstance(self.law, kind) else None


register_model(LawType)(models.OpaqueModel)


@typeof_impl.register(FrictionLaw)
def _typeof(law, context):
    return LawType(law)


@unbox(LawType)
def _unbox(law_type, law, context):
    return NativeValue(context.context.get_dummy_value())


@lower_constant(LawType)  # (a kernel for the GPU has its law as a constant)
def _constant(context, builder, law_type, law):
    return context.get_dummy_value()


@overload(rows_of, **_inlined)
def _rows_of(law):
    """`rows_of` in compiled code: a constant."""
    rows = rows_of(law.law)
    return lambda law: rows
