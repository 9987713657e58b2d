"""Overshoots of the load point are not steps; brief holds, pulses and second steps are."""

import numpy as np
import pytest

from ratestate.records.load_point.segments import Segments, segments_from_displacement

SLOW, FAST = 1e-5, 1e-4


def steady(V, lasts):
    """Segments with these speeds and durations, without overshoots."""
    *starts, end = np.append(0.0, np.cumsum(lasts))
    nothing = np.zeros(len(V))
    found = Segments(np.array(starts), np.array(V), end, nothing, nothing)
    return found.without_overshoots()


@pytest.mark.parametrize(
    ("V", "lasts"),
    [
        ((SLOW, 1.06 * FAST, FAST), (60, 0.088, 6)),
        ((SLOW, 1.4 * FAST, FAST), (60, 0.05, 6)),
        ((FAST, 0.4 * SLOW, SLOW), (6, 0.2, 60)),
        ((FAST, 0.0, SLOW), (6, 0.2, 60)),
        ((0.0, 1.2 * SLOW, SLOW), (100, 0.3, 60)),
        ((SLOW, 1.1 * FAST, 0.97 * FAST, FAST), (60, 0.05, 0.05, 6)),
    ],
)
def test_overshoots_belong_to_their_step(V, lasts):
    """The step begins where its first brief speed does."""
    found = steady(V, lasts)
    assert found.V.tolist() == [V[0], V[-1]]
    assert found.t.tolist() == [0.0, lasts[0]]
    assert found.displacement(sum(lasts)) == pytest.approx(np.dot(V, lasts))


@pytest.mark.parametrize(
    ("V", "lasts"),
    [
        ((SLOW, 1.06 * FAST, FAST), (60, 1.0, 6)),  # long: a second step
        ((SLOW, 2.0 * FAST, FAST), (60, 0.05, 6)),  # far beyond the speed after it
        ((SLOW, 1.4 * FAST, FAST), (60, 0.2, 6)),  # 8 um, beside 600 um
        ((SLOW, 0.0, SLOW), (60, 1.0, 60)),  # a brief hold
        ((SLOW, FAST, SLOW), (60, 0.1, 60)),  # a pulse
        ((FAST, 0.0, SLOW), (6, 0.5, 60)),  # 5 um, beside 600 um
    ],
)
def test_other_brief_speeds_are_steps(V, lasts):
    found = steady(V, lasts)
    assert found.V.tolist() == list(V)
    np.testing.assert_allclose(found.t, np.cumsum([0, *lasts[:-1]]))


def test_the_history_counts_the_step_once():
    """The segments keep the overshoot, which fits follow, and a note tells it."""
    t = np.concatenate([np.arange(0, 59, 0.05), np.arange(59, 66, 0.005)])
    x = np.interp(t, [0, 60, 60.088, 66], np.cumsum([0, 600e-6, 9.328e-6, 591.2e-6]))
    noise = 5e-8 * np.random.default_rng(1).standard_normal(t.size)
    found = segments_from_displacement(t, x + noise)
    np.testing.assert_allclose(found.V, [SLOW, 1.06 * FAST, FAST], rtol=0.02)
    assert found.describe(t).count("velocity step") == 1
    assert "velocity step 10 -> 100 um/s" in found.describe(t)
    (note,) = found.notes
    assert "overshoots to 10" in note
