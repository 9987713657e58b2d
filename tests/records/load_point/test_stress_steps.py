"""Steps of normal stress in a record, and how its history tells them."""

import numpy as np
import pytest
import xarray
from synthetic_records import power_law

from ratestate.records.load_point.stress_steps import VARIABLE, stress_range, stress_steps
from ratestate.records.reading import read_lab

T = np.arange(1200) * 0.5
NOISE = 5e3 * np.random.default_rng(3).normal(size=T.size)


def test_stress_steps_have_their_times_and_levels():
    sigma = 8e6 + 0.8e6 * (T > 200.2) - 2.8e6 * (T > 400.2) + NOISE
    first, second = stress_steps(T, sigma)
    assert (first.t, second.t) == (pytest.approx(200.25), pytest.approx(400.25))
    assert (first.end, second.end) == (first.t, second.t)
    ends = [first.before, first.after, second.before, second.after]
    np.testing.assert_allclose(ends, [8e6, 8.8e6, 8.8e6, 6e6], rtol=1e-3)


@pytest.mark.parametrize("lasts", [0.1, 0.3, 1.0, 3.0, 10.0])
@pytest.mark.parametrize("change", [0.1, -0.25])
def test_ramps_from_begin_to_end(lasts, change):
    """A servo takes its time: to a row or two, or to a tenth of the ramp."""
    t = np.arange(0.0, 300.0, 0.1)
    part = np.interp(t, [100.03, 100.03 + lasts, 200.0, 200.0 + lasts], [0.0, 1.0, 1.0, 0.0])
    sigma = 8e6 * (1.0 + change * part + 1e-4 * np.random.default_rng(2).normal(size=t.size))
    found = stress_steps(t, sigma)
    assert len(found) == 2
    for one, begin in zip(found, (100.03, 200.0), strict=True):
        assert abs(one.t - begin) < 0.15 + 0.1 * lasts
        assert abs(one.end - begin - lasts) < 0.15 + 0.1 * lasts
    levels = 8e6 * np.array([1.0, 1.0 + change])
    np.testing.assert_allclose([found[0].before, found[0].after], levels, rtol=1e-4)
    np.testing.assert_allclose([found[1].after, found[1].before], levels, rtol=1e-4)


def test_a_level_lasts_twice_as_long_as_the_change():
    for lasts, count in ((20.0, 1), (60.0, 0)):
        sigma = 8e6 * (1.0 + 0.1 * np.interp(T, [500.0, 500.0 + lasts, 600.0], [0.0, 1.0, 1.0]))
        assert len(stress_steps(T[T < 600.0], (sigma + NOISE)[T < 600.0])) == count


def range_of(sigma):
    return stress_range(xarray.Dataset({"sigma": ("time", sigma)}, {"time": T[: sigma.size]}))


def test_the_range_of_normal_stress_is_without_its_noise():
    assert range_of(8e6 + 20.0 * NOISE) == range_of(8e6 + NOISE) == range_of(8e6 + 0.0 * T) == 0.0
    bump = 0.05 * np.interp(T, [300.0, 310.0, 320.0], [0.0, 1.0, 0.0])
    assert range_of(8e6 * (1.0 + bump) + NOISE) == pytest.approx(0.05, rel=0.1)
    assert range_of(np.where(T > 200.0, -8e6, 8e6)) == 0.0
    assert stress_range(xarray.Dataset({"sigma": 8e6})) == 0.0
    assert stress_range(xarray.Dataset()) == 0.0


SHAPES = {
    "none": lambda t: 0.0 * t,
    "drift": lambda t: t / 600.0,
    "servo": lambda t: np.where(t > 301.0, 1.0 - np.exp(-(t - 301.0) / 1.5), 0.0),
    "returns": lambda t: np.where(t > 301.0, np.exp(-(t - 301.0) / 12.0), 0.0),
    "sinusoid": lambda t: 0.5 * np.sin(2.0 * np.pi * t / 40.0),
    "half a period": lambda t: np.sin(np.pi * t / 600.0),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("exponent", [0.0, 1.0])
def test_normal_stress_varies_by_two_per_cent_or_by_noise(shape, exponent):
    """Noise of 0.2 %, white or 1/f, in which no more than 5 % of constant records seem to vary."""
    found = []
    for seed in range(40):
        noise = power_law(T.size, exponent, np.random.default_rng(seed))
        found.append(range_of(8e6 * (1.0 + 0.02 * SHAPES[shape](T) + 2e-3 * noise)))
    varies = np.mean(np.array(found) > VARIABLE)
    assert varies <= 0.05 if shape == "none" else varies >= 0.95
    if shape != "none":
        assert 0.012 < np.median(found) < 0.027


def test_slow_noise_is_not_a_normal_stress_that_varies():
    """1/f noise of 0.5 %, whose range is beyond 1 % of the mean."""
    found = [power_law(250, 1.0, np.random.default_rng(seed)) for seed in range(40)]
    ranges = [range_of(8e6 * (1.0 + 5e-3 * noise / noise.std())) for noise in found]
    assert np.mean(np.array(ranges) > VARIABLE) <= 0.05


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
def test_other_histories_have_no_step(sigma):
    assert stress_steps(T, sigma) == []


@pytest.mark.parametrize(("speed", "first"), [(3.0, "velocity step"), (1.0, "no step: steady")])
def test_the_history_lists_stress_steps_in_order_of_time(tmp_path, speed, first):
    """After a step of the load point, or at one speed throughout."""
    moved = np.where(T > 100.0, 100.0 + speed * (T - 100.0), T)
    sigma = 8.0 + 0.8 * (T > 400.2)
    friction = 0.6 + 1e-4 * np.random.default_rng(1).normal(size=T.size)
    path = tmp_path / "stress.txt"
    columns = np.column_stack([T, moved, friction, sigma])
    head = "Time(s)\tDispl(microns)\tFriction\tNormal_stress(MPa)"
    np.savetxt(path, columns, "%.9g", "\t", header=head, comments="")
    data = read_lab(path)
    assert "no step or hold is found" not in data.attrs["notes"]
    before, last = data.attrs["found"].split("; ")
    assert before.startswith(first)
    at = 100.0 + speed * 300.25
    assert last == f"step of normal stress 8 -> 8.8 MPa at 400.2 s ({at:.0f} um)"
    columns[:, 3] = 8.0
    np.savetxt(path, columns, "%.9g", "\t", header=head, comments="")
    assert ("no step or hold is found" in read_lab(path).attrs["notes"]) == (speed == 1.0)
