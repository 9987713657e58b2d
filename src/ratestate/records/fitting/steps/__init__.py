"""Fits of each step and hold of a record: an experiment in one call of `fit`.

============== ==========================================================================
``windows``    steps and holds of a record, each with its window, and slides in stick-slip
``each``       what is free in each window, and the fits of the windows, in parallel
``shared``     one set of the law's parameters for all steps; scatter, steps up and down
``experiment`` the whole fit with each="step"; alpha from steps of normal stress
``result``     the Dataset along ``step``
============== ==========================================================================

A `Window` has one of three kinds.  A step or a hold of the load point is fitted with all free
parameters except alpha, and enters the joint fit.  A step of normal stress is fitted last, with
alpha alone.
"""

#: kinds of steps
STEP, HOLD, NORMAL_STRESS = "step", "hold", "normal stress"
#: status of a step under a law
FITTED, FAILED, STICK_SLIP = 0, 1, 2
