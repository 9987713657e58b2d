"""Do the intervals hold what they promise?  Records drawn over a realistic range tell.

README has what 200 records give, 68 and 95 %; half of them are enough to see a mistake.
"""

import numpy as np
import pytest
from records import drawn

import ratestate as rs
from ratestate.fitting.unknowns import to_coordinate

RECORDS = 100
FREE = ("a", "b", "Dc", "K")
pytestmark = pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")


def fitted():
    """(records, parameters, levels) whether the interval holds the truth; signed errors; kinds."""
    held, errors, kinds = [], [], []
    for seed in range(RECORDS):
        case = drawn(seed)
        result = rs.fit(case.data, case.start)
        truth = np.array([getattr(case.truth, name) for name in FREE])
        ends = result.interval.sel(parameter=list(FREE)).values
        low, high = ends[..., 0], ends[..., 1]
        held.append((low <= truth[:, None]) & (truth[:, None] <= high))
        errors.append(
            [
                to_coordinate(name, float(result[name])) - to_coordinate(name, value)
                for name, value in zip(FREE, truth, strict=True)
            ]
        )
        kinds.append((case.is_red, case.truth.M > 0))
    return np.array(held), np.array(errors), np.array(kinds)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """(One test: the records are drawn and fitted once.)"""
    held, errors, kinds = fitted()
    part = held.mean(axis=(0, 1))
    assert 0.60 < part[0] < 0.76
    assert 0.91 < part[1] < 0.98
    # of each parameter: within three binomial errors of 100 draws
    for index, name in enumerate(FREE):
        assert 0.54 < held[:, index, 0].mean() < 0.82, name
        assert 0.885 < held[:, index, 1].mean() <= 0.995, name
    for column, what in enumerate(("correlated noise", "inertia")):
        for kind in (False, True):
            part = held[kinds[:, column] == kind].mean(axis=(0, 1))
            assert 0.59 < part[0] < 0.77, (what, kind)
            assert 0.90 < part[1] < 0.985, (what, kind)
    middle = np.median(errors / np.std(errors, axis=0), axis=0)
    assert (np.abs(middle) < 0.3).all(), "estimates are biased"
