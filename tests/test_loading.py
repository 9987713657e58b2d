"""What the load point does: values, exact integrals against fractions, bad records."""

import re
from fractions import Fraction

import numpy as np
import pint
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from ratestate import Loading, ParameterError, logspace

#: 1 mm/s, a step to 3, a hold, a ramp back to 2 (the record's jumps are repeated times)
T = [0.0, 1.0, 1.0, 2.0, 2.0, 4.0, 4.0, 6.0]
V = [1e-3, 1e-3, 3e-3, 3e-3, 0.0, 0.0, 0.0, 2e-3]


def test_steps():
    loading = Loading.steps("1 mm/s", (1.0, "3 mm/s"), ("2000 ms", 0))
    assert loading.t.tolist() == [0, 1, 2]
    assert loading.V.tolist() == [1e-3, 3e-3, 0]
    assert loading.rate.tolist() == [0, 0, 0]
    assert loading.t_last == np.inf
    assert loading.V_first == 1e-3
    t = np.array([0, 0.5, 1, 1.5, 2, 1e9])
    np.testing.assert_array_equal(loading.V_load(t), [1e-3, 1e-3, 3e-3, 3e-3, 0, 0])
    np.testing.assert_allclose(
        loading.delta_lp(t), [0, 0.5e-3, 1e-3, 2.5e-3, 4e-3, 4e-3], rtol=1e-15
    )


def test_constant():
    loading = Loading.constant("3.2 mm/s")
    assert (loading.t.size, loading.V_first, loading.t_last) == (1, 0.0032, np.inf)
    assert type(loading.V_first) is float
    assert loading.V_load(7.0) == 0.0032
    assert loading.delta_lp(10.0) == 0.032
    loading.covers(1e12)
    swept = Loading.constant(xr.DataArray([1e-3, 2e-3], dims="V_lp"))
    np.testing.assert_array_equal(swept.delta_lp(3.0).coords["V_lp"], [1e-3, 2e-3])
    with pytest.raises(ParameterError, match="V = -1 m/s must be >= 0"):
        Loading.constant(-1)


def test_series_with_jumps_a_hold_and_a_ramp():
    loading = Loading.series(T, V)
    assert loading.t.tolist() == [0, 1, 2, 4]
    assert loading.V.tolist() == [1e-3, 3e-3, 0, 0]
    assert loading.rate.tolist() == [0, 0, 0, 1e-3]
    assert loading.t_last == 6
    t = np.array([6, 0, 1, 2, 3, 4, 5])  # in any order
    np.testing.assert_allclose(
        loading.V_load(t), [2e-3, 1e-3, 3e-3, 0, 0, 0, 1e-3], rtol=1e-15, atol=0
    )
    np.testing.assert_allclose(
        loading.delta_lp(t), [6e-3, 0, 1e-3, 4e-3, 4e-3, 4e-3, 4.5e-3], rtol=1e-15, atol=0
    )
    loading.covers(6)
    loading.covers(xr.DataArray([1.0, 6.0], dims="x"))


@pytest.mark.parametrize(
    ("t", "speeds"),
    [
        (np.array(T), np.array(V)),
        (tuple(T), ["1 mm/s", "1 mm/s", "3 mm/s", 3e-3, 0, "0 m/s", 0, "2 mm/s"]),
        (xr.DataArray(T, dims="time"), xr.DataArray(V, dims="time", attrs={"units": "m/s"})),
        (xr.DataArray(np.array(T) * 1e3, dims="i", attrs={"units": "ms"}), V),
        (np.array(T, dtype=int), pint.UnitRegistry().Quantity(np.array(V) * 1e3, "mm/s")),
    ],
)
def test_forms_of_a_record(t, speeds):
    loading = Loading.series(t, speeds)
    np.testing.assert_array_equal(loading.t, [0, 1, 2, 4])
    np.testing.assert_array_equal(loading.V, [1e-3, 3e-3, 0, 0])
    np.testing.assert_array_equal(loading.rate, [0, 0, 0, 1e-3])


@settings(deadline=None, max_examples=50)
@given(
    st.lists(st.tuples(st.floats(1e-6, 1e3), st.floats(0, 10)), min_size=2, max_size=30),
    st.lists(st.floats(0, 1), min_size=1, max_size=10),
)
def test_the_integral_is_exact(rows, where):
    t = np.concatenate([[0.0], np.cumsum([dt for dt, _ in rows[1:]])])
    speeds = np.array([v for _, v in rows])
    times = np.array(where) * t[-1]
    got = Loading.series(t, speeds).delta_lp(times)
    for time, delta in zip(times, got, strict=True):
        exact = Fraction(0)
        for t0, t1, v0, v1 in zip(t, t[1:], speeds, speeds[1:], strict=False):
            t0, t1, v0, v1 = map(Fraction, (t0, t1, v0, v1))
            s = min(Fraction(time), t1) - t0
            if s > 0:
                exact += v0 * s + (v1 - v0) * s * s / (t1 - t0) / 2
        assert abs(Fraction(delta) - exact) <= Fraction(2e-15) * exact + Fraction(1e-320)


def test_long_records_are_fast_and_lose_no_digits():
    rng = np.random.default_rng(1)
    t = np.concatenate([[0], np.cumsum(rng.uniform(1e-4, 2e-3, 99_999))])
    speeds = rng.uniform(0, 1e-3, t.size)
    speeds[::100] = 0  # holds
    loading = Loading.series(t, speeds)
    assert loading.V.shape == loading.rate.shape == loading.t.shape == (99_999,)
    exact = sum(
        Fraction(dt) * (Fraction(v0) + Fraction(v1)) / 2
        for dt, v0, v1 in zip(np.diff(t), speeds, speeds[1:], strict=False)
    )
    assert loading.delta_lp(t[-1]) == pytest.approx(float(exact), rel=1e-15, abs=0)
    assert (np.diff(loading.delta_lp(t)) > 0).all()
    middle = (t[1:] + t[:-1]) / 2
    assert (loading.V_load(np.concatenate([t, middle])) >= 0).all()
    np.testing.assert_allclose(loading.V_load(t), speeds, rtol=1e-12, atol=1e-18)


def test_no_ramp_to_rest_overshoots_to_negative_speed():
    rng = np.random.default_rng(2)
    for dt, speed in rng.uniform(0.1, 10, (300, 2)):
        end = Loading.series([0, dt], [speed, 0]).V_load(dt)
        assert 0 <= end < 1e-14


def test_speeds_that_are_named_arrays_broadcast():
    V1 = logspace("V_lp", 1e-4, 1e-1, 4)
    V2 = xr.DataArray([0.0, 1.0], dims="after")
    loading = Loading.steps("0.1 mm/s", (1, V1), (2, V2))
    assert loading.V.dims == loading.rate.dims == ("V_lp", "after", "segment")
    t = np.array([0.0, 1.5, 3.0])
    speed, delta = loading.V_load(t), loading.delta_lp(t)
    assert speed.dims == delta.dims == ("V_lp", "after", "time")
    assert (speed.name, delta.name) == ("V_load", "delta_lp")
    assert (speed.attrs["units"], delta.attrs["units"]) == ("m/s", "m")
    assert loading.V_first.dims == ("V_lp", "after")
    for v1 in V1.values:
        for i, v2 in enumerate(V2.values):
            one = Loading.steps(1e-4, (1, v1), (2, v2))
            np.testing.assert_array_equal(speed.sel(V_lp=v1)[i], one.V_load(t))
            np.testing.assert_array_equal(delta.sel(V_lp=v1)[i], one.delta_lp(t))


def test_times_of_each_case():
    V1 = logspace("V_lp", 1e-3, 1e-1, 3)
    t = xr.DataArray([[0.5, 1, 2], [0, 1, 3], [0.1, 2, 9]], {"V_lp": V1}, ("V_lp", "time"))
    swept = Loading.steps(1e-4, (1, V1))
    plain = Loading.steps(1e-4, (1, 1e-2))
    for form in (t, t.T):
        delta = swept.delta_lp(form)
        assert delta.dims == ("V_lp", "time")
        for i, v in enumerate(V1.values):
            one = Loading.steps(1e-4, (1, v))
            np.testing.assert_array_equal(delta[i], one.delta_lp(t[i].values))
            np.testing.assert_array_equal(swept.V_load(form)[i], one.V_load(t[i].values))
        assert plain.delta_lp(form).dims == ("V_lp", "time")
        np.testing.assert_array_equal(plain.delta_lp(form), plain.delta_lp(t.values))
    final = swept.delta_lp(t[:, -1])  # as t_end of each case
    assert final.dims == ("V_lp",)
    np.testing.assert_array_equal(final, swept.delta_lp(t)[:, -1])


def test_series_of_named_arrays():
    V1 = logspace("V_lp", 1e-3, 1e-1, 3)
    loading = Loading.series([0, 1, 1, 3], [0, V1, 0, 2 * V1])
    assert loading.V.dims == ("V_lp", "segment")
    np.testing.assert_allclose(loading.rate, np.outer(V1, [1, 1]), rtol=1e-15)
    np.testing.assert_allclose(loading.delta_lp(3.0), 2.5 * V1, rtol=1e-15)


@pytest.mark.parametrize(
    ("steps", "message"),
    [
        (("3.2 mm",), "V_start = '3.2 mm' is a length [m]; expected a speed [m/s]"),
        ((-1.0,), "V_start = -1 m/s must be >= 0"),
        ((1.0, (1, -2.0)), "V_lp from t = 1.0 s on = -2 m/s must be >= 0"),
        ((1.0, (1, np.nan)), "is not a number"),
        ((1.0, (0, 2.0)), "t of step 1 = 0 s must be > 0"),
        (
            (1.0, (2, 2.0), (1, 3.0)),
            "t = 1.0 s of step 2 must come after t = 2.0 s; give the steps in",
        ),
        ((1.0, (2, 2.0), (2, 3.0)), "t = 2.0 s of step 2 must come after t = 2.0 s"),
        ((1.0, ("1 m", 2.0)), "t of step 1 = '1 m' is a length [m]; expected a time [s]"),
        ((1.0, (logspace("t", 1, 2, 3), 2.0)), "the time of a step is one number"),
        ((1.0, 2.0), "step 2.0 is not a pair"),
        (
            (logspace("V_lp", 1, 2, 3), (1.0, logspace("V_lp", 1, 3, 3))),
            "V_start and V_lp from t = 1.0 s on have different coordinates along the dimen",
        ),
    ],
)
def test_bad_steps(steps, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        Loading.steps(*steps)


@pytest.mark.parametrize(
    ("t", "speeds", "message"),
    [
        ([0, 2, 1], [1, 1, 1], "t[2] = 1.0 s is less than t[1] = 2.0 s: times must not decrease"),
        ([0, np.nan, 1], [1, 1, 1], "t = nan s at row[1] is not a number"),
        ([0, 1, 1, 1, 2], [1] * 5, "t[2] = 1.0 s is repeated a third time"),
        ([0, 0, 1], [1, 2, 3], "t[0] = 0.0 s is repeated at an end"),
        ([0, 1, 1], [1, 2, 3], "t[2] = 1.0 s is repeated at an end"),
        ([0.5, 1], [1, 2], "t[0] = 0.5 s must be 0: subtract it"),
        ([-1, 1], [1, 2], "t = -1 s at row[0] must be >= 0"),
        ([0, 1], [1, 2, 3], "t has 2 and V_lp 3 values"),
        ([0], [1], "at least 2"),
        ([0, 1], [1, -2], "V_lp = -2 m/s at row[1] must be >= 0"),
        ([0, 1], [1, np.inf], "V_lp = inf m/s at row[1] must be finite"),
        ([0, 1], [1, "2 mm"], "V_lp[1] = '2 mm' is a length [m]; expected a speed"),
        ([0, 1], [1, None], "V_lp[1] = None is of type NoneType"),
        ([0, 1], [True, True], "V_lp[0] = True is of type bool"),
        ([0, 1], np.ones((2, 2)), "V_lp has 2 dimensions; a column has 1"),
        ([0, 1], 3.0, "V_lp = 3.0 is not a column of values"),
        ([0, 1e-310], [0, 10], "too close for a ramp"),
        ([0, logspace("t", 1, 2, 2)], [0, 10], "as many times as speeds"),
    ],
)
def test_bad_series(t, speeds, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        Loading.series(t, speeds)


def test_outside_the_history():
    loading = Loading.series([0, 10], [1e-3, 2e-3])
    with pytest.raises(ParameterError, match=r"t_end = 12.0 s is beyond .* series, 10.0 s; s"):
        loading.covers(12)
    with pytest.raises(ParameterError, match=r"t_end = 11.0 s is beyond"):
        loading.covers(xr.DataArray([11.0, 9.0], dims="x"))
    for bad in (10.5, -1.0, np.nan):
        with pytest.raises(ParameterError, match=r"is outside the loading, 0 to 10.0 s"):
            loading.V_load(np.array([1.0, bad]))
