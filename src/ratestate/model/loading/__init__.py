"""What the load point does: a velocity, piecewise linear in time, with jumps allowed.

How a new shape of periodic loading is added, stands in shapes.py.  The engine needs nothing: it
gets segments, made in history.py (steps, series), events.py (step, hold, ramp) or shapes.py.
"""

from .history import Loading

__all__ = ["Loading"]
