"""Frictional healing in slide-hold-slide tests: the function `healing` and its parts.

============== ==================================================================
``healing``    the function `healing`: the sequence of steps
``record``     samples, holds and slides; slip of the fault; the noise in slides
``steady``     steady friction of each slide, with a drift, after its transient
``measured``   healing and relaxation of one hold, with errors and status
``prediction`` predictions for a hold, by a slider or a fit
``result``     the Dataset
============== ==================================================================
"""
