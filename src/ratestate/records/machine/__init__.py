"""Stiffness, mass and damping of a machine: the function `machine_stiffness` and its parts.

===================== =============================================================
``machine_stiffness`` the function `machine_stiffness`; stress drops; ring-downs
``slopes``            where the spring loads or unloads; friction there and its fit: creep
                      at constant state, and healing
``ring_down``         free oscillations: frequency and decay; mass and damping
``result``            the Dataset, and `summary`, it as text
===================== =============================================================
"""

from .result import summary

__all__ = ["summary"]
