"""Fits of laboratory records: the function `fit` and its parts.

A fit goes through one code, whatever is fitted: a forward model (`forward`, `cycles.problem`),
whitened residuals (`problem`), search and covariance (`solutions`), intervals
(`inference`), warnings (`checks`) and the Dataset (`fit_dataset`).

Modules are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .marginal import log_likelihood

__all__ = ["log_likelihood"]

#: public name -> module that defines it
_HOMES = {"log_likelihood": "marginal"}


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return __all__
