"""Fits of laboratory records: the function `fit` and its parts.

=============================== =================================================================
``fit``                         the function `fit`: what is done for which settings
``settings``                    which settings of `fit` are refused
``record``                      which records can be fitted sample by sample
``unknowns``                    parameters that may be free: coordinates, bounds, starts
``forward``                     friction of a slider, its derivatives, motions by the engine
``problem``                     residuals, and where searches start
``generalized_least_squares``   the best fit, its covariance, and score tests
``estimates``                   errors, intervals and correlation from a covariance; what is open
``likelihood``                  what is reported, its intervals; profiles, posterior
``diagnostics``                 warnings and identifiability
``result``                      the Dataset of a fit; laws compared
``steps``                       every step and hold of an experiment, and one set for all
``cycles``                      the fit of stick-slip or vibration by features of its cycles
``by_law``                      the way back: estimates and `slider_of` from such a Dataset
``table``, ``text``             estimates as cells; `summary`, all of a fit as text
=============================== =================================================================

Nothing heavy is loaded until it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .by_law import slider_of
    from .likelihood.marginal import log_likelihood
    from .text import summary

__all__ = ["log_likelihood", "slider_of", "summary"]

#: public name -> module that defines it
_HOMES = {"log_likelihood": "likelihood.marginal", "slider_of": "by_law", "summary": "text"}


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return __all__
