"""Stiffness, mass and damping of a machine: the function `machine_stiffness` and its parts.

===================== =============================================================
``machine_stiffness`` the function `machine_stiffness`; stress drops; ring-downs
``slopes``            loading and unloading of the spring, fitted with creep at constant
                      state and healing
``ring_down``         free oscillations: frequency and decay; mass and damping
``result``            the Dataset
===================== =============================================================
"""
