"""Loadings: values, integrals compared with exact fractions, and bad records."""

import pickle
import re
from fractions import Fraction

import numpy as np
import pint
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from ratestate import Loading, ParameterError, SpringSlider, logspace
from ratestate.model.arrays import isel
from ratestate.model.units import to_si

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
def test_all_forms_of_a_record_give_the_same_loading(t, speeds):
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


V1 = logspace("V_lp", 1e-4, 1e-2, 3)
V2 = xr.DataArray([0.0, 1e-3], dims="after")
#: loadings from two speeds, each a number or an array with a dimension of its own
MADE = {
    "steps": lambda v1, v2: Loading.steps("0.1 mm/s", (1, v1), (2, v2)),
    "series": lambda v1, v2: Loading.series([0, 1, 1, 3], [v2, v1, v2, 2 * v1]),
    "events": lambda v1, v2: Loading.constant(v2).step(1, v1).hold(2, 0.5).ramp(2.7, v2, 0.2),
    "sinusoid": lambda v1, v2: Loading.sinusoid(v1, 0.1 * v2, period=1, t_end=3),
}


@pytest.mark.parametrize("make", MADE.values(), ids=MADE)
def test_speeds_that_are_named_arrays_give_all_combinations(make):
    swept, t = make(V1, V2), np.array([0.0, 1.5, 3.0])
    for values in (swept.V, swept.rate):
        assert {*values.dims} == {"V_lp", "after", "segment"}
    speed, delta = swept.V_load(t), swept.delta_lp(t)
    assert (speed.name, speed.attrs["units"]) == ("V_load", "m/s")
    assert (delta.name, delta.attrs["units"]) == ("delta_lp", "m")
    for v1 in V1.values:
        for i, v2 in enumerate(V2.values):
            one = make(v1, v2)
            for many, alone in ((speed, one.V_load(t)), (delta, one.delta_lp(t))):
                np.testing.assert_array_equal(many.sel(V_lp=v1).isel(after=i), alone)
            np.testing.assert_array_equal(swept.rate.sel(V_lp=v1).isel(after=i), one.rate)


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


@pytest.mark.parametrize(
    ("t", "speeds", "message"),
    [
        ([0, 2, 1], [1, 1, 1], "t[2] = 1.0 s is less than t[1] = 2.0 s"),
        ([0, np.nan, 1], [1, 1, 1], "t = nan s at row[1] is not a number"),
        ([0, 1, 1, 1, 2], [1] * 5, "t[2] = 1.0 s is repeated a third time"),
        ([0, 0, 1], [1, 2, 3], "t[0] = 0.0 s is repeated at an end"),
        ([0.5, 1], [1, 2], "t[0] = 0.5 s must be 0"),
        ([0, 1], [1, 2, 3], "t has 2 and V_lp 3 values"),
        ([0], [1], "at least 2"),
        ([0, 1], [1, -2], "V_lp = -2 m/s at row[1] must be >= 0"),
        ([0, 1], [1, "2 mm"], "V_lp[1] = '2 mm' is a length"),
        ([0, 1], [1, None], "V_lp[1] = None is of type NoneType"),
        ([0, 1], np.ones((2, 2)), "V_lp has 2 dimensions"),
        ([0, 1], 3.0, "V_lp = 3.0 is not a column of values"),
        ([], [], "t has no values"),
        ([0, 1e-310], [0, 10], "too close for a ramp"),
        ([0, logspace("t", 1, 2, 2)], [0, 10], "as many times as speeds"),
    ],
)
def test_bad_series(t, speeds, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        Loading.series(t, speeds)


def test_times_outside_the_history_are_refused():
    loading = Loading.series([0, 10], [1e-3, 2e-3])
    with pytest.raises(ParameterError, match=r"t_end = 12.0 s is beyond .* series, 10.0 s"):
        loading.covers(12)
    with pytest.raises(ParameterError, match=r"t_end = 11.0 s is beyond"):
        loading.covers(xr.DataArray([11.0, 9.0], dims="x"))
    for bad in (10.5, -1.0, np.nan):
        with pytest.raises(ParameterError, match=r"is outside the loading"):
            loading.V_load(np.array([1.0, bad]))


def test_steps_holds_and_ramps_in_sequence():
    loading = (
        Loading.constant("1 mm/s")
        .step("1 s", "3 mm/s")
        .hold(2, "10 s")
        .step(12, "2 mm/s")  # where the hold ends
        .ramp(20, 0, 5)
        .ramp(25, "4 mm/s", 4)  # where the ramp ends
        .hold("30 s", 1)
    )
    assert loading.t.tolist() == [0, 1, 2, 12, 20, 25, 29, 30, 31]
    assert loading.V.tolist() == [1e-3, 3e-3, 0, 2e-3, 2e-3, 0, 4e-3, 0, 4e-3]
    assert loading.rate.tolist() == [0, 0, 0, 0, -2e-3 / 5, 1e-3, 0, 0, 0]
    assert loading.t_last == np.inf
    same = Loading.series(
        [0, 1, 1, 2, 2, 12, 12, 20, 25, 29, 30, 30, 31, 31, 40],
        np.array([1, 1, 3, 3, 0, 0, 2, 2, 0, 4, 4, 0, 0, 4, 4]) * 1e-3,
    )
    t = np.linspace(0, 40, 401)
    np.testing.assert_allclose(loading.V_load(t), same.V_load(t), rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(loading.delta_lp(t), same.delta_lp(t), rtol=1e-14, atol=0)


def test_a_step_may_begin_when_a_ramp_to_the_same_speed_ends():
    loading = Loading.constant(1.0).ramp(0.1, 1.0, 0.2).step(0.3, 2.0)  # 0.1 + 0.2 > 0.3
    assert loading.t.tolist() == [0, 0.1, 0.1 + 0.2]
    assert loading.V.tolist() == [1, 1, 2]


@pytest.mark.parametrize(
    ("event", "message"),
    [
        (lambda x: x.step(5, 1.0), "t = 5.0 s must come after t = 5.0 s, because the hist"),
        (lambda x: x.hold(7, 1).step(7.5, 1.0), "t = 7.5 s must come after t = 8.0 s"),
        (lambda x: x.step(6, -1.0), "V_lp from t = 6.0 s on = -1 m/s must be >= 0"),
        (lambda x: x.hold(6, 0), "hold = 0 s must be > 0"),
        (lambda x: x.hold(6, 1e-17), "hold = 1e-17 is too short or too long after t = 6.0 s"),
        (lambda x: x.ramp(6, 1, "1 m"), "ramp = '1 m' is a length"),
        (lambda x: x.ramp(6, 1e300, 1e-15), "ramp = 1e-15 is too short. For a jump"),
        (lambda x: x.step(logspace("t", 6, 7, 2), 1.0), "t is an array, but must be one number"),
        (lambda x: Loading.series([0, 1], [1, 1]).step(2, 1), "the history ends at t = 1.0 s"),
        (lambda x: Loading.steps("3.2 mm"), "V_lp = '3.2 mm' is a length"),
        (lambda x: Loading.steps(1.0, 2.0), "step 2.0 is not a pair"),
        (
            lambda x: x.step(6, logspace("V_lp", 1, 2, 2)).step(7, logspace("V_lp", 1, 3, 2)),
            "V_lp before and V_lp from t = 7.0 s on have different coordinates along the dimension",
        ),
    ],
)
def test_bad_events(event, message):
    with pytest.raises(ParameterError, match=re.escape(message)):
        event(Loading.steps(1.0, (5, 2.0)))


MEAN, PERIOD = 1e-3, 2.0
OMEGA = 2 * np.pi / PERIOD


def test_errors_of_a_sinusoid():
    loading = Loading.sinusoid("1 mm/s", "1 mm/s", frequency="0.5 Hz", t_end="10 s")
    assert loading.calls[0].arguments["frequency"] == "0.5 Hz"
    assert (loading.t_last, loading.V_first, loading.mean_speed) == (10.0, MEAN, MEAN)
    t = np.linspace(0, 10, 100_001)
    speed = MEAN * (1 + np.sin(OMEGA * t))
    error = abs(loading.V_load(t) - speed).max() / MEAN
    assert 4.9e-5 < error < 5.1e-5
    delta = MEAN * t + MEAN / OMEGA * (1 - np.cos(OMEGA * t))
    assert 1.1e-7 < abs(loading.delta_lp(t) - delta).max() * OMEGA / MEAN < 1.3e-7
    assert loading.V_load(t).min() > 0  # a true sinusoid touches 0
    loading.covers(10)
    with pytest.raises(ParameterError, match="beyond the end"):
        loading.covers(10.1)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"amplitude": 1.1e-3}, "amplitude = 0.0011 m/s is more than V_lp = 0.001 m/s"),
        ({"period": None}, "needs either a period or a frequency"),
        ({"frequency": 1}, "needs either a period or a frequency"),
        ({"period": None, "frequency": 1e-320}, "is out of range"),
        ({"period": logspace("period", 1, 2, 2)}, "the period of a sinusoid is an array"),
        ({"t_end": 1e4}, "2.56e+06 straight lines for each of 1 cases"),
        ({"t_end": 1e3, "V_lp": logspace("V_lp", 1e-3, 1, 50)}, "and 1e+07 in all)"),
    ],
)
def test_bad_sinusoids(changes, message):
    arguments = {"V_lp": 1e-3, "amplitude": 1e-3, "period": 1.0, "t_end": 10.0} | changes
    with pytest.raises(ParameterError, match=re.escape(message)):
        Loading.sinusoid(**arguments)


@pytest.mark.parametrize("function", ["V_load", "delta_lp", "sigma"])
def test_times_of_a_loading_may_have_units(function):
    """Text, quantities, lists and arrays are valid; other values are refused."""
    loading = Loading.constant("10 um/s").step("1 s", "20 um/s").sigma_ramp("2 s", "4 MPa", "2 s")
    at = getattr(loading, function)
    more = ["2 MPa"] if function == "sigma" else []
    expected = {"V_load": 2e-5, "delta_lp": 5e-5, "sigma": 3e6}[function]
    array = xr.DataArray(3000.0, attrs={"units": "ms"})
    for t in ("3 s", 3, 3.0, "3000 ms", np.float64(3.0), pint.Quantity(3, "s"), array):
        assert float(at(t, *more)) == pytest.approx(expected, rel=1e-14)
    for many in ([1, 3], ["1 s", "3 s"], np.array([1, 3]), (1.0, 3.0)):
        assert at(many, *more)[-1] == pytest.approx(expected, rel=1e-14)
    step = np.timedelta64(3, "s")
    for t in ("3 m", "x", None, step, [step], ["a"], {"t": 3}, 1j, np.array(["a"]), True, np.nan):
        with pytest.raises(ParameterError, match=r"^t\b"):
            at(t, *more)
    if more:
        for sigma in ("3 s", None, [2e6], -1.0, np.nan):
            with pytest.raises(ParameterError, match=r"^sigma\b"):
                at(3.0, sigma)


@pytest.mark.parametrize("loading", [Loading.constant(1), Loading.constant(1).sigma_step(1, 5e6)])
def test_slider_at_takes_one_time(loading):
    slider = SpringSlider(a=0.01, b=0.015, Dc=1e-5, sigma=2e6, K=1e9)
    after = 5e6 if loading.normal_stress else 2e6
    for t in (2.0, "2 s", np.float64(2.0), xr.DataArray(2.0), np.inf):
        assert loading.slider_at(t, slider).sigma == after
    for t in ("2 m", np.timedelta64(2, "s"), -1.0, [1.0, 2.0], xr.DataArray([1.0], dims="t")):
        with pytest.raises(ParameterError, match=r"^t "):
            loading.slider_at(t, slider)


def test_a_loading_keeps_the_calls_that_made_it():
    speeds = xr.DataArray([1.0, 2.0], dims="V_lp", attrs={"units": "mm/s"})
    steps = Loading.steps("1 mm/s", ("1 s", "3.2 mm/s"), (2, 1e-3))
    loading = steps.hold(3, duration="1 s").ramp("5 s", speeds, 1)
    loading = loading.sigma_step("2 s", 2e6).sigma_sinusoid("1 kPa", frequency="3 Hz")
    *calls, ramp, step, wave = loading.calls
    assert [(call.method, call.arguments) for call in (*calls, step, wave)] == [
        ("constant", {"V_lp": "1 mm/s"}),
        ("step", {"t": "1 s", "V_lp": "3.2 mm/s"}),
        ("step", {"t": 2.0, "V_lp": 1e-3}),
        ("hold", {"t": 3.0, "duration": "1 s"}),
        ("sigma_step", {"t": "2 s", "sigma": 2e6}),
        ("sigma_sinusoid", {"amplitude": "1 kPa", "frequency": "3 Hz"}),
    ]
    assert ramp.arguments["V_lp"].equals(to_si("V_lp", speeds))

    assert pickle.loads(pickle.dumps(loading)).calls[:4] == loading.calls[:4]
    assert isel(loading, {"V_lp": slice(1, 2)}).calls[4].arguments["V_lp"].values == [2e-3]
    again = Loading
    for call in loading.calls:
        again = call.apply_to(again)
    assert again.V.equals(loading.V)
    assert again.normal_stress.t.tolist() == loading.normal_stress.t.tolist()


@pytest.mark.parametrize("speed", [1e-6, xr.DataArray([1e-6, 2e-6], dims="case")])
def test_a_history_in_shorter_segments_has_the_same_values(speed):
    pull = Loading.constant(speed).ramp(1.0, "8 um/s", 3.0).hold(6.0, 2.0)
    refined = pull.speed.refined(np.union1d(pull.t, [0.5, 2.0, 3.0, 7.0, 9.0]))
    assert refined.t.size == 10
    t = np.linspace(0.0, 10.0, 41)
    np.testing.assert_allclose(refined.at(t), pull.speed.at(t), rtol=1e-14, atol=1e-20)
