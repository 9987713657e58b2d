"""Reports on results: tables and sentences that say what a person wants to know first."""

from .report import Report
from .summary import summary

__all__ = ["Report", "summary"]
