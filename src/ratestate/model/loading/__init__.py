"""What the load point does: a velocity, piecewise linear in time, with jumps allowed.

A new shape is a class method of `Loading` in history.py.  Other places know it by its name: in
interfaces/scenario known_keys, loading_table, as_python, as_toml and results, which read and write
it, and dynamics/results, which records it.  The engine needs nothing: it gets segments.
"""

from .history import Loading

__all__ = ["Loading"]
