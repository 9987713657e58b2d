"""Sliders of a fit in the engine's march: its cases, and the motion at the samples."""

import numpy as np

from ...engine import dispatch
from ...engine.model import FINISHED, Cases


def cases_of(*, kappa, **columns):
    """`Cases` of n sliders under one loading; a column may be one value for all of them."""
    columns = {"loading": 0, "observe": 0.0, "sigma": 1.0, "kappa": kappa} | columns
    each = {k: np.full(kappa.size, v) if np.ndim(v) == 0 else v for k, v in columns.items()}
    return Cases(**each)


def marched(law, cases, loads, times):
    """(n, m, 2 + states) x, v, psi (engine/model.py) of the cases at these times.

    NaN where a run fails.
    """
    results = dispatch.run_march(True, law, cases, loads, times, np.arange(cases.kappa.size))
    results.saved[results.status != FINISHED] = np.nan
    return results.saved
