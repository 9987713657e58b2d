"""Stiffness, mass and damping of a machine: the function `machine_stiffness` and its parts.

========================== ============================================================
``machine_stiffness``      the function `machine_stiffness`: in which order all is done
``stress_drops``           stress drops of stick-slip, and the loading between them
``slopes``                 where the spring loads or unloads
``loading_fit``            fits of friction there, with its noise
``loading_curve``          the curve that is fitted: creep at constant state, and healing
``ring_down``              free oscillations: frequency and decay
``inertia``                mass and damping from these, with friction taken out
``result``                 the Dataset
``text``                   `summary`, the Dataset as text
========================== ============================================================
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
