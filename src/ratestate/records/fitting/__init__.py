"""Fits of laboratory records: the function `fit` and its parts.

=============================== =================================================================
``fit``                         the function `fit`
``settings``                    checks of the settings of `fit`
``record``                      the samples and the loading of a record that is fitted
``unknowns``                    parameters that may be free: coordinates, bounds, starting ranges
``forward``                     friction of a slider and its derivatives, by the engine
``problem``                     residuals, and points from which searches start
``generalized_least_squares``   the best fit, its covariance, and score tests
``estimates``                   errors, intervals and correlation from a covariance
``likelihood``                  reported quantities and their intervals; profiles, posterior
``diagnostics``                 warnings and identifiability
``result``                      the Dataset of a fit; comparison of laws
``steps``                       fits of every step and hold of an experiment, and a joint fit
``cycles``                      fits of stick-slip or vibration by features of the cycles
``by_law``                      estimates, and the function `slider_of`, from such a Dataset
=============================== =================================================================

Modules are imported when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .by_law import slider_of
    from .likelihood.marginal import log_likelihood

__all__ = ["log_likelihood", "slider_of"]

#: public name -> module that defines it
_HOMES = {"log_likelihood": "likelihood.marginal", "slider_of": "by_law"}


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return __all__
