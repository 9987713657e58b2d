"""Frictional healing in slide-hold-slide tests: the function `healing` and its parts.

============== ==================================================================
``healing``    the function `healing`: in which order all below is done
``record``     samples, holds and slides; slip of the fault; the noise of slides
``steady``     steady friction of each slide, with a drift, after its transient
``measured``   healing and relaxation of one hold, with errors; its status
``prediction`` sliders, perhaps of a fit, and what they predict for a hold
``result``     the Dataset, and `summary`, it as text
============== ==================================================================
"""

from .result import summary

__all__ = ["summary"]
