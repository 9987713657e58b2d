"""The solver: machine code of a law's units, and the control that calls them.

The engine handles numbers and arrays only: no xarray, no units of measurement.  `dispatch` runs
cases from Python, and docs/developer/engine.md explains how the modules work together.
"""
