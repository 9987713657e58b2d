"""The solver: machine code for each law, and the loop that steps many sliders with it.

The engine handles numbers and arrays only: no xarray, no units of measurement.  `dispatch` runs
cases from Python, and docs/developer/engine.md explains how the modules work together.
"""
