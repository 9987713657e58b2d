"""Stick-slip events of a record or a run."""

from .catalogue import events

__all__ = ["events"]
