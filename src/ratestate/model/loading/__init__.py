"""What the load point does: a velocity, piecewise linear in time, with jumps allowed."""

from .history import Loading

__all__ = ["Loading"]
