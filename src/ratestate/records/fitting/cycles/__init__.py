"""Fits of limit cycles, stick-slip or vibration, by features of the cycles.

==================== ==========================================================================
``fit``              the fit of a record: which runs are continued, how far errors are enlarged
``segments``         parts of a record at one speed; refuses irregular cycles
``folding``          refuses mere noise; cuts a part into cycles, and folds them into one
``features``         the six numbers that are compared
``measured``         gives features their errors; which of them a record resolves
``model``            waves and features of a slider's limit cycle, where it has one
``space``            coordinates, and which sliders and parameters cannot be fitted
``search``           least squares from many starts; which ends are distinct
``profile``          intervals where chi-squared is no parabola
``diagnostics``      the note on what is determined, and warnings
``diagnostics.toml`` sentences on fits of cycles
``result``           the Dataset of such a fit
==================== ==========================================================================
"""
