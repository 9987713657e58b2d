"""Frictional healing in slide-hold-slide tests: the function `healing` and its parts.

============================ ==========================================================
``healing``                  the function `healing`: in which order all below is done
``record``, ``holds``        samples, holds, and the slides before and after them
``fault_slip``               slip of the fault
``slide_noise``              the noise of friction that slides show
``sliding``                  steady friction of each slide, with a drift common to all
``transients``               how friction approaches its steady level after reloading
``peak``                     the peak on reloading
``measured``                 healing and relaxation of one hold, with errors; its status
``rate``                     healing and relaxation per decade of hold time
``sliders``, ``prediction``  sliders, perhaps of a fit, and what they predict for a hold
``result``                   the Dataset
``text``                     `summary`, the Dataset as text
============================ ==========================================================
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .text import summary

__all__ = ["summary"]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.text"), name)


def __dir__():
    return __all__
