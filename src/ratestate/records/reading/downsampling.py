"""Fewer rows than were recorded: means over blocks of neighbours.

A mean over k rows is the anti-alias filter whose effects are exactly known: white noise of
variance s^2 has s^2/k after it, a straight line is a straight line, a step stays within one block
(no ringing before or after it), and an oscillation of period P, over blocks that last B, is
weakened by the factor sin(pi B/P)/(pi B/P), which is 0 at the rate of the new samples.
"""

import itertools

import numpy as np

from ...model.units import is_integer
from ..messages import reading as sentences

#: most rows that are kept, by default: `fit` takes a fifth of that, and one of many steps less
MOST = 1_000_000
FEWEST = 1_000


def checked_most(rows):
    """The most rows to keep, as given, None for all; ParameterError for what is no such number."""
    if rows is not None and not (is_integer(rows) and rows >= FEWEST):
        raise sentences.refusal("rows.most", rows=rows, fewest=FEWEST, most=MOST)
    return rows


def downsample(rows, most):
    """Let each of the `Rows` be the mean over a block, with a warning, if they are more than most.

    most : int, or None for any number
    """
    n = rows.kept.size
    if most is None or n <= most:
        return
    before = float(np.median(np.diff(rows.record["time"])))
    starts, factor = blocks(n, rows.gaps, most)
    rows.kept = rows.kept[starts + factor // 2]
    for symbol, values in rows.record.items():
        rows.record[symbol] = means(values, starts)
    after = float(np.median(np.diff(rows.record["time"])))
    rows.gaps = np.searchsorted(starts, rows.gaps)
    values = {"n": n, "kept": starts.size, "factor": factor, "before": before, "after": after}
    rows.warnings.append(sentences("notes.means", **values))


def blocks(n, gaps, most):
    """First row of each block of n rows, and how many rows are in each; no block has a gap inside.

    gaps : (gaps,) rows before which there is one

    The last block before a gap has the rows that are left over as well, or it has fewer.
    """
    factor = -(-n // most)
    edges = [0, *gaps, n]
    parts = [
        first + factor * np.arange(max(1, (end - first) // factor))
        for first, end in itertools.pairwise(edges)
    ]
    return np.concatenate(parts), factor


def means(values, starts):
    """Mean of values (n,) over each block (starts,)."""
    return np.add.reduceat(values, starts) / np.diff(np.append(starts, values.size))
