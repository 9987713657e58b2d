"""Fits of each step and hold of a record, as `fit` does with per_step=True.

A `StepWindow` has one of three kinds.  A step or a hold of the load point is fitted with all free
parameters except alpha, and enters the joint fit.  A step of normal stress is fitted last, with
alpha alone.
"""

#: kinds of steps
STEP, HOLD, NORMAL_STRESS = "step", "hold", "normal stress"
#: status of a step under a law
FITTED, FAILED, STICK_SLIP = 0, 1, 2
