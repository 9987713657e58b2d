"""Laws inside compiled code: a type for each, and its methods.

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
    overload_method,
    register_model,
    typeof_impl,
    unbox,
)

from ..friction.laws import EvolutionLaw, SlipLaw
from .jit import INLINED

#: what the methods of every law are called, and their arguments
METHODS = {name: value for name, value in vars(SlipLaw).items() if inspect.isfunction(value)}


class LawType(types.Type):
    """The type of a law, which is all that compiled code knows of it: it has no value."""

    def __init__(self, law):
        super().__init__(f"{law.__module__}.{law.__qualname__}")
        self.law = law


register_model(LawType)(models.OpaqueModel)


@typeof_impl.register(EvolutionLaw)
def _typeof(law, context):
    return LawType(type(law))


@unbox(LawType)
def _unbox(law_type, law, context):
    return NativeValue(context.context.get_dummy_value())


@lower_constant(LawType)  # (a kernel for the GPU has its law as a constant)
def _constant(context, builder, law_type, law):
    return context.get_dummy_value()


_overload: Any = overload_method  # (its declared arguments lack jit_options)

for _name, _method in METHODS.items():

    @_overload(LawType, _name, jit_options=INLINED)
    @functools.wraps(_method)  # numba compares the arguments
    def _of_law(self, *arguments, name=_name):
        """The function that ``law.name(...)`` is in compiled code, for the GPU too."""
        return getattr(self.law, name)
