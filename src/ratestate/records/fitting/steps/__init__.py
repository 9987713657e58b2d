"""Fits of each step and hold of a record: an experiment in one call of `fit`.

============== ==========================================================================
``experiment`` what `fit` does if each="step"; alpha from steps of normal stress
``windows``    steps and holds, each with its part of the record; slides that are stick-slip
``each``       the fits of these parts, in parallel
``shared``     one set of the law's parameters for all; scatter, steps up and steps down
``result``     the Dataset along ``step``
``text``       it as tables, sentences, and rows of a CSV
============== ==========================================================================
"""

#: status of a step or hold under a law
FITTED, FAILED, STICK_SLIP = 0, 1, 2
