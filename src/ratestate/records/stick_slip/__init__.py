"""Stick-slip events of a record or a run: the function `events` and its parts.

=================== =============================================================================
``events``          the function `events`
``catalogue``       in which order all below is done; quantities, status and message of each event
``series``          shear stress and load point of a record or a run, checked
``detection``       which falls of the stress are events, and where they roughly are; the noise
``falls``           peaks, troughs, times and slip rates of falls in a record, and in a run
``extremes``        an extreme of a noisy stress, or of its slope, without bias; its window
``between_samples`` when stress falls through a level; peaks between samples; hidden events
``lines``           stiffness from the loading; stress drop against log recurrence and log V_lp
=================== =============================================================================
"""

from .events import events

__all__ = ["events"]
