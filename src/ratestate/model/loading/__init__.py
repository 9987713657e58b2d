"""What the load point does: a velocity, piecewise linear in time, with jumps allowed.

================== ==================================================================
``history``        `Loading`: the ways in which a history is made
``segments``       speed and displacement at any time; how far a history covers
``events``         where a step, hold or ramp may be put
``stress_history`` normal stress beside the speed, and where its events may be put
``normal_stress``  what it is: steps, ramps, a record, a sinusoid
``record``         which rows of times and speeds are a history
``shapes``         periodic loading: waves about a mean speed
``written``        a history in the words that make it again
================== ==================================================================

How a new shape of periodic loading is added, stands in shapes.py.  The engine needs nothing: it
gets segments, made in history.py (steps, series), events.py (step, hold, ramp) or shapes.py.
"""

from .history import Loading

__all__ = ["Loading"]
