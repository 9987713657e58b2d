"""Stick-slip events of a record or a run: the function `events` and its parts.

=================== =============================================================================
``events``          the function `events`
``catalogue``       the sequence of steps; quantities, status and message of each event
``series``          checked shear stress and load point of a record or a run
``detection``       falls of the stress that are events, to the nearest sample; the noise
``falls``           peaks, troughs, times and slip rates of falls, in a record or a run
``extremes``        unbiased extremes of a noisy stress or of its slope, and their windows
``between_samples`` times of falls and peaks between samples; events that samples merge or hide
``lines``           stiffness from the loading; stress drop against log recurrence and log V_lp
=================== =============================================================================
"""

from .events import events

__all__ = ["events"]
