"""Reports on results: tables and sentences that say what a person wants to know first.

================ ===========================================================
``report``       `Report`, and `summary`, which makes it of any result
``single``       a run, a cycle, stability, a branch, a frequency response
``sweep``        a sweep: how cases ended, ranges, failed cases
``domain``       cases that leave the domain of the friction law
``fit``          a fit, or the fits of steps and holds
``estimates``    estimates of fits as cells of tables
``steps``        fits of steps and holds: cells, sentences, rows of CSV
``evaluations``  events, healing, and the stiffness of a machine
``tables``       tables and their cells
================ ===========================================================
"""

from .report import Report, summary

__all__ = ["Report", "summary"]
