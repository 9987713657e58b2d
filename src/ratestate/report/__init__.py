"""Reports on results: tables and sentences with the most important answers."""

from .report import Report
from .summary import summary

__all__ = ["Report", "summary"]
