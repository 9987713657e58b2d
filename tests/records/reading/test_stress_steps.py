"""Steps of normal stress in a record, and how its history tells them."""

import numpy as np
import pytest

from ratestate.records.reading import read_lab
from ratestate.records.reading.stress_steps import stress_steps

T = np.arange(1200) * 0.5
NOISE = 5e3 * np.random.default_rng(3).normal(size=T.size)


def test_levels_and_times():
    sigma = 8e6 + 0.8e6 * (T > 200.2) - 2.8e6 * (T > 400.2) + NOISE
    first, second = stress_steps(T, sigma)
    assert (first.t, second.t) == (pytest.approx(200.25), pytest.approx(400.25))
    ends = [first.before, first.after, second.before, second.after]
    np.testing.assert_allclose(ends, [8e6, 8.8e6, 8.8e6, 6e6], rtol=1e-3)


@pytest.mark.parametrize(
    "sigma",
    [
        8e6 + NOISE,
        8e6 * (1.0 + 0.3 * T / T[-1]) + NOISE,  # a ramp
        8e6 * (1.0 + 0.1 * np.sin(T / 20.0)) + NOISE,
        np.where(T > 200.0, np.nan, 8e6),
        np.where(T > 200.0, -8e6, 8e6),
    ],
)
def test_what_is_no_step(sigma):
    assert stress_steps(T, sigma) == []


@pytest.mark.parametrize(("speed", "first"), [(3.0, "velocity step"), (1.0, "no step: steady")])
def test_the_history_has_them_in_order_of_time(tmp_path, speed, first):
    """After a step of the load point, or at one speed throughout."""
    moved = np.where(T > 100.0, 100.0 + speed * (T - 100.0), T)
    sigma = 8.0 + 0.8 * (T > 400.2)
    friction = 0.6 + 1e-4 * np.random.default_rng(1).normal(size=T.size)
    path = tmp_path / "stress.txt"
    columns = np.column_stack([T, moved, friction, sigma])
    head = "Time(s)\tDispl(microns)\tFriction\tNormal_stress(MPa)"
    np.savetxt(path, columns, "%.9g", "\t", header=head, comments="")
    before, last = read_lab(path).attrs["found"].split("; ")
    assert before.startswith(first)
    at = 100.0 + speed * 300.25
    assert last == f"step of normal stress 8 -> 8.8 MPa at 400.2 s ({at:.0f} um)"
