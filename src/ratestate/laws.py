"""Names for writing a friction law, and the catalogue of all laws.

`FrictionLaw` is the base class, and `Parameter` describes a parameter.  A formula may use the
functions exp, expm1, log, log1p, sqrt, sinh, cosh, tanh, asinh, abs, minimum, maximum and where.
`catalogue` lists the built-in and the registered laws.
"""

from builtins import abs  # noqa: A004  (formulas use it too)
from collections.abc import Mapping
from typing import NamedTuple

from .friction.composition import composed, forms_of
from .friction.functions import asinh, cosh, exp, expm1, log, log1p, sinh, sqrt, tanh, where
from .friction.functions import larger as maximum
from .friction.functions import smaller as minimum
from .friction.law import FrictionLaw
from .friction.law_formula import Parameter
from .friction.laws import LAW_NAMES, LAWS

__all__ = [
    "FrictionLaw",
    "LawEntry",
    "Parameter",
    "abs",
    "asinh",
    "catalogue",
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


def __dir__():
    return __all__


class LawEntry(NamedTuple):
    """A friction law in the `catalogue`.

    Attributes
    ----------
    name : str
        The name that results record.
    names : tuple of str
        All names that select the law, in small letters.
    label : str
        The name for titles and legends.
    forms : dict
        Forms of friction that the law takes, its own form first.  Each maps the symbols of the
        parameters that a slider needs in addition to a, b, Dc, sigma and K to a `Parameter`.
    """

    name: str
    names: tuple[str, ...]
    label: str
    forms: Mapping[str, Mapping[str, Parameter]]


def catalogue():
    """Return the friction laws that `SpringSlider` takes.

    Returns
    -------
    list of `LawEntry`
        The built-in laws, then the registered laws.

    Examples
    --------
    >>> [law.name for law in catalogue()][:5]
    ['slip', 'aging', 'flash-heating', 'kato-tullis', 'nagata']
    """
    return [
        LawEntry(
            name,
            tuple(known for known, its in LAW_NAMES.items() if its == name),
            law.label,
            {form: dict(composed(law, form).parameters) for form in forms_of(law)},
        )
        for name, law in LAWS.items()
    ]
