"""Fits of limit cycles, stick-slip or vibration, by features of the cycles.

============ ==========================================================================
``folding``  the segments of a record, cut into cycles, which are folded into one
``features`` the six numbers that are compared
``measured`` gives features their errors; which of them a record resolves
``model``    waves and features of a slider's limit cycle, where it has one
``problem``  coordinates, residuals and starts of the least squares
``fit``      the fit of a record, its Dataset, its notes and warnings
============ ==========================================================================
"""
