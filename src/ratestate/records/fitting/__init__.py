"""Fits of laboratory records: the function `fit` and its parts.

Nothing heavy is loaded until it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .by_law import slider_of
    from .text import summary

__all__ = ["slider_of", "summary"]

#: public name -> module that defines it
_HOMES = {"slider_of": "by_law", "summary": "text"}


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return __all__
