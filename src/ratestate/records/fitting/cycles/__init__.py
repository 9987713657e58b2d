"""Fits of limit cycles, stick-slip or vibration, by features of the cycles.

============ ==========================================================================
``folding``  segments of a record, cut into cycles, which are averaged into one cycle
``features`` the six features that are compared
``measured`` features of a record with their errors; features that it resolves
``model``    waves and features of a slider's limit cycle
``problem``  coordinates, residuals and starting points of the least squares
``fit``      the fit of a record, its Dataset, notes and warnings
============ ==========================================================================
"""
