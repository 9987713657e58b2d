"""Names for writing a friction law.

`FrictionLaw` is the base class, `Parameter` describes a parameter, and the functions take the
quantities in formulas: exp, expm1, log, log1p, sqrt, sinh, cosh, tanh, asinh, abs, minimum,
maximum, where.
"""

from builtins import abs  # noqa: A004  (formulas use it too)

from .friction.functions import asinh, cosh, exp, expm1, log, log1p, sinh, sqrt, tanh, where
from .friction.functions import larger as maximum
from .friction.functions import smaller as minimum
from .friction.law import FrictionLaw
from .friction.law_formula import Parameter

__all__ = [
    "FrictionLaw",
    "Parameter",
    "abs",
    "asinh",
    "cosh",
    "exp",
    "expm1",
    "log",
    "log1p",
    "maximum",
    "minimum",
    "sinh",
    "sqrt",
    "tanh",
    "where",
]
