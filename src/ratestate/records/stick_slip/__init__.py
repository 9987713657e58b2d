"""Stick-slip events of a record or a run."""

from .find_events import events

__all__ = ["events"]
