"""Reports on results: tables and sentences that say what a person wants to know first.

=============== ==========================================================================
``summary``     the function of this name, which makes the report on any result
``report``      `Report`: rows and sentences, and how they become text, HTML and Markdown
``single``      a run, a cycle, stability, a branch, a frequency response
``many_cases``  a sweep: how cases ended, ranges, failed cases, those outside the domain
``fits``        fits of a whole record
``steps``       fits of steps and holds, and rows of CSV
``evaluations`` events, healing, and the stiffness of a machine
``summary_csv`` what a whole record tells, as CSV
=============== ==========================================================================
"""

from .report import Report
from .summary import summary

__all__ = ["Report", "summary"]
