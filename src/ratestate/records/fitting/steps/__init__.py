"""Fits of each step and hold of a record: an experiment in one call of `fit`.

==================== ==========================================================================
``experiment``       what `fit` does where each="step"
``stick_slip``       slides that are stick-slip, whose steps are not fitted
``windows``          steps and holds, each with its part of the record
``each``             the fits of these parts, in parallel
``fitted``           such a part, and its fits
``shared``           one set of the law's parameters for all, and a test whether it serves
``stress_response``  alpha from steps of normal stress
``comparison``       scatter between steps; steps up beside steps down
``result``           the Dataset along ``step``
``recorded``         in it what was recorded
``table``, ``cells`` it as text
``rows``             it as rows of a CSV
==================== ==========================================================================
"""
