"""Stick-slip events of a record or a run: the function `events` and its parts.

=============================== =================================================================
``events``                      the function `events`
``catalogue``                   in which order all below is done; status, message, recurrence
``series``                      shear stress and load point of a record or a run, checked
``outliers``                    samples that stand out by themselves, and are no events
``detection``                   which falls of the stress are events, and where they roughly are
``significance``                whether they are more than noise that wanders
``noise``                       the noise in the loading, white or correlated
``crossings``                   when the stress of an event falls through the middle
``hidden``                      several events in one fall, small ones in the loading
``spikes``                      peaks and troughs between samples
``edges``                       an extreme at the edge of the loading, next to a fall
``polynomials``                 an extreme of a noisy stress, or of its slope, without bias
``windows``                     the window around alike extremes
``recorded``                    peaks, troughs, times and slip rates in a noisy record
``computed``                    the same in a run, whose slip velocity is known
``stiffness``                   the spring's stiffness from the loading between events
``measures``                    drop, slip, slip rate, work, kind of each event
``trends``                      stress drop against the logarithm of recurrence and of V_lp
``result``                      the Dataset
=============================== =================================================================
"""

from .events import events

__all__ = ["events"]
