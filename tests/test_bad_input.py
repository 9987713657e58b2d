"""What cannot be used is refused at once: a message with symbol, value, unit and remedy."""

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate import Loading, ParameterError, limit_cycle, simulate

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, M=3e3, K=9e8)
LOADING = Loading.constant(1e-3)
CALL = "ratestate.paper.im2017(slider, loading, t_end, dt)"
NAN, INF = float("nan"), float("inf")


def axis(values, coordinate=None):
    return xr.DataArray(values, dims="q", coords=None if coordinate is None else {"q": coordinate})


@pytest.mark.parametrize(
    ("settings", "symbol", "value", "remedy"),
    [
        ({"t_end": 0}, "t_end", "0 s", "such as '10 s'"),
        ({"t_end": INF}, "t_end", "inf s", "must be finite"),
        ({"t_end": "3 mm"}, "t_end", "'3 mm'", "such as '10 s'"),
        ({"times": [0.5, 2.0]}, "times", "2 s", "Extend t_end or drop"),
        ({"times": [0.5, 1.0 + 1e-9]}, "times", "t_end = 1 s", "Extend t_end or drop"),
        ({"times": [0.5, 0.5]}, "times", "", "must increase"),
        ({"times": [-0.1, 0.5]}, "times", "-0.1 s", "must be >= 0"),
        ({"times": axis([0.1, 0.2]).expand_dims("r")}, "times", "('r', 'q')", "must be 'time'"),
        ({"method": "rk4"}, "method", "'rk4'", "auto, rodas5p"),
        ({"method": "im2017"}, "method", "'im2017'", CALL),
        ({"dt": 1e-4}, "simulate", "dt", CALL),
        ({"rtol": 1e-15}, "rtol", "1e-15", "from 1e-13 to 0.1"),
        ({"rtol": 1.0}, "rtol", "1.0", "from 1e-13 to 0.1"),
        ({"rtol": NAN}, "rtol", "nan", "such as 1e-6"),
        ({"rtol": axis([1e-6])}, "rtol", "", "one number"),
        ({"initial": {"V": 0.0}}, "initial V", "0 m/s", "must be > 0"),
        ({"initial": {"theta": "1 m"}}, "initial theta", "'1 m'", "a time"),
        ({"initial": {"tau": NAN}}, "initial tau", "nan Pa", "a stress"),
        ({"initial": {"mu": 0.6}}, "initial", "{'mu': 0.6}", "V, theta and tau"),
        # of limit_cycle
        ({"V_lp": 0.0}, "V_lp = 0 m/s", "must be > 0", "'3.2 mm/s'"),
        ({"V_lp": axis([1e-3, -1e-3])}, "V_lp", "-0.001 m/s", "must be > 0"),
        ({"V_lp": 1e-3, "V_start": 0.0}, "V_start", "0 m/s", "must be > 0"),
        ({"V_lp": 1e-3, "V_start": axis([1e-4, 1e-3])}, "V_start", "V_lp", "such as 1 % less"),
        ({"V_lp": 1e-3, "rtol": 1e-14}, "rtol", "1e-14", "from 1e-12 to 1e-2"),
        ({"V_lp": 1e-3, "rtol": 0.5}, "rtol", "0.5", "from 1e-12 to 1e-2"),
    ],
)
def test_wrong_settings_are_refused(settings, symbol, value, remedy):
    run = {} if "V_lp" in settings else {"loading": LOADING, "t_end": 1.0}
    with pytest.raises(ParameterError) as caught:
        (simulate if run else limit_cycle)(SLIDER, **run | settings)
    for part in (symbol, value, remedy):
        assert part in str(caught.value)
    assert isinstance(caught.value, ValueError)
    assert caught.value.__suppress_context__ or caught.value.__context__ is None


@pytest.mark.parametrize(
    ("slider", "loading", "more", "symbols"),
    [
        (axis([1.0, 2.0], [0, 1]), axis([1e-3, 2e-3], [5, 6]), {}, "M V"),
        (axis([1.0, 2.0]), axis([1e-3, 2e-3, 3e-3]), {}, "M V"),
        (axis([1.0, 2.0], [0, 1]), 1e-3, {"V_start": axis([1e-3, 2e-3], [5, 6])}, "M V_start"),
        (axis([1.0, 2.0], [0, 1]), 1e-3, {"t_end": axis([1.0, 2.0], [5, 6])}, "M t_end"),
        (axis([1.0, 2.0]), 1e-3, {"initial": {"theta": axis([1.0] * 3)}}, "M theta"),
        (
            axis([1.0, 2.0]),
            1e-3,
            {"times": xr.DataArray(np.tile([0.1, 0.2], (3, 1)), dims=["q", "time"])},
            "M time",
        ),
        (3e3, axis([1e-3, 2e-3], [0, 1]), {"V_start": axis([1e-3, 2e-3], [5, 6])}, "V_start V_lp"),
    ],
)
def test_clashing_coordinates(slider, loading, more, symbols):
    with pytest.raises(ParameterError, match=r"along the dimension 'q'") as caught:
        simulate(SLIDER.replace(M=slider), Loading.constant(loading), **{"t_end": 1.0} | more)
    for symbol in symbols.split():
        assert symbol in str(caught.value)


def test_limit_cycle_with_clashing_coordinates():
    slider = SLIDER.replace(M=axis([1.0, 2.0], [0, 1]))
    with pytest.raises(ParameterError, match=r"M and V_lp have different coordinates"):
        limit_cycle(slider, axis([1e-3, 2e-3], [5, 6]))


@pytest.mark.parametrize("name", ["tau", "status", "V", "amplitude"])
def test_a_dimension_named_like_a_result(name):
    slider = SLIDER.replace(M=xr.DataArray([1.0, 2.0], dims=name))
    with pytest.raises(ParameterError, match=rf"{name}.*Rename"):
        simulate(slider, LOADING, 0.1)


def test_series_too_short():
    series = Loading.series([0, 1.0], [1e-3, 2e-3])
    with pytest.raises(ParameterError, match=r"t_end = 2.0 s is beyond .* 1.0 s"):
        simulate(SLIDER, series, 2.0)
    with pytest.raises(ParameterError, match=r"t_end = 1.5 s is beyond"):
        simulate(SLIDER, series, axis([0.5, 1.5]))
    assert simulate(SLIDER, series, 1.0, times=[1.0]).status == 0


@pytest.mark.parametrize(
    "loading",
    [
        Loading.constant(0.0),
        Loading.steps(0.0, (1.0, 1e-3)),
        Loading.series([0, 1.0], [0.0, 1e-3]),
        Loading.constant(axis([1e-3, 0.0])),
    ],
    ids=["constant", "steps", "series", "one of two"],
)
def test_start_at_rest(loading):
    with pytest.raises(ParameterError, match=r"V_lp = 0 m/s at t = 0.*V_start='1 um/s'"):
        simulate(SLIDER, loading, 0.5)
    assert (simulate(SLIDER, loading, 0.5, V_start="1 um/s", times=[0.5]).status == 0).all()


def test_rigid_drive_at_rest():
    """One case raises; in a batch the others go on."""
    loading = Loading.steps(1e-3, (0.5, 0.0))
    with pytest.raises(
        (ParameterError, rs.SolverError), match=r"V_lp = 0 m/s with K = inf.*finite K"
    ) as caught:
        simulate(SLIDER.replace(K=INF), loading, 1.0)
    assert "nan" not in str(caught.value)
    batch = simulate(SLIDER.replace(K=xr.DataArray([INF, 3e9], dims="K")), loading, 1.0)
    assert batch.status[0] > 1
    assert batch.status[1] == 0
    assert np.isnan(batch.V.values).tolist() == [[True], [False]]


@pytest.mark.parametrize("call", [lambda x: simulate(x, LOADING, 1.0), lambda x: limit_cycle(x, 1)])
def test_wrong_kind_of_argument(call):
    with pytest.raises((ParameterError, TypeError), match="SpringSlider"):
        call(1e-3)


def test_a_speed_beyond_double_precision_without_mass():
    slider = SLIDER.replace(M=0.0)
    assert rs.stability(slider, 0.9e50).eta == 0.0
    with pytest.raises(ParameterError, match=r"^V_lp\^2 = 10\^320 is beyond .* units of V_lp\."):
        rs.stability(slider, 1e160)


def test_sizes_beyond_double_precision():
    """Both sides of each limit, of numbers whose powers and exponentials no double holds."""
    slider = rs.SpringSlider(a=0.005, b=0.008, Dc=1e-5, sigma=4e6, M=100.0, K=0.96e9, V0=1e-6)
    refused = r"^M V_lp\^2/\(a sigma Dc\) = 10\^100\.7 is beyond .* Check the sizes and units of M,"
    with pytest.raises(ParameterError, match=refused):
        rs.stability(slider, 1e49)
    assert np.isfinite(rs.stability(slider, 1e48).eigenvalues).all()
    for Dc in (5e-324, 1e-106):
        tiny = slider.replace(Dc=axis([Dc, 1e-5]))
        with pytest.raises(ParameterError, match=r"^a sigma/\(K Dc\) = 10\^"):
            rs.stability(tiny, 1e-30)
    assert np.isfinite(rs.stability(slider.replace(Dc=1e-90), 1e-30).eigenvalues).all()
    with pytest.raises(ParameterError, match=r"^K Dc/\(a sigma\) = 10\^204\.7"):
        limit_cycle(slider.replace(Dc=1e200), 1e-3)
    loading = Loading.constant(1e-5)
    for start in ({"V_start": 2.6e-267}, {"initial": {"V": 2.6e-267}}):
        with pytest.raises(ParameterError, match=r"V.* = 2\.6e-267 m/s is out of range: .* V0"):
            simulate(slider, loading, 1.0, **start)
    with pytest.raises(ParameterError, match=r"V_start = 2\.6e-264 m/s is .* times V_lp = 0\.001"):
        limit_cycle(slider, axis([1e-3, 1e-6]), V_start=2.6e-264)
    assert int(limit_cycle(slider, 1e-3, V_start=2.7e-264).status) == 0
    run = simulate(slider, loading, 1.0, V_start=2.7e-267, times=[0.0, 1.0])
    assert float(run.V[0]) == pytest.approx(2.7e-267, rel=1e-12)
    assert np.isfinite(run.mu).all()


RECORD = xr.Dataset(
    {
        "friction": ("time", 0.6 + 1e-4 * np.random.default_rng(0).normal(size=400)),
        "delta_lp": ("time", 1e-6 * np.linspace(0.0, 40.0, 400)),
        "segment_t": ("segment", [0.0, 10.0, 20.0]),
        "segment_V": ("segment", [1e-6, 0.0, 1e-6]),
    },
    {"time": np.linspace(0.0, 40.0, 400)},
)
EVALUATE = {
    "fit": lambda data: rs.fit(data, SLIDER, ("a", "b", "Dc")),
    "fit of each step": lambda data: rs.fit(data, SLIDER, ("a", "b", "Dc"), per_step=True),
    "events": lambda data: rs.events(data, sigma="2 MPa"),
    "healing": rs.healing,
    "machine_stiffness": lambda data: rs.machine_stiffness(data, sigma="2 MPa"),
}


@pytest.mark.parametrize("evaluate", EVALUATE.values(), ids=EVALUATE)
def test_a_record_with_altered_segments_is_refused(evaluate):
    altered = [
        RECORD.drop_vars("segment_t"),
        RECORD.drop_vars("segment_V"),
        *(RECORD.isel(segment=part) for part in (slice(0, 0), 0, slice(None, None, -1))),
        RECORD.assign(segment_V=RECORD.segment_V.astype(str)),
        RECORD.assign(segment_t=RECORD.segment_t.where(RECORD.segment_t > 0.0)),
    ]
    for data in altered:
        with pytest.raises(ParameterError, match="segments of the record are incomplete"):
            evaluate(data)


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (rs.fit, {"per_step": np.array([True, False])}),
        (rs.fit, {"law": 3}),
        (rs.fit, {"free": np.array([["a", "b"]])}),
        (rs.fit, {"noise": axis([1e-4, 2e-4])}),
        (rs.healing, {"trend": np.array(["slip", "time"])}),
        (rs.healing, {"noise": axis([1e-4, 2e-4])}),
        (rs.events, {"sigma": xr.Dataset()}),
        (rs.machine_stiffness, {"sigma": axis([1e6, 2e6])}),
    ],
)
def test_arrays_for_what_is_one_thing_are_refused(function, arguments):
    given = {"slider": SLIDER, "free": ("a", "b", "Dc")} if function is rs.fit else {}
    with pytest.raises(ParameterError, match=next(iter(arguments))):
        function(RECORD, **given | arguments)


@pytest.mark.parametrize("value", [np.array(["cpu", "cuda"]), axis([1.0, 2.0]), {}, 3, NAN])
def test_arrays_for_settings_of_sweeps_and_branches_are_refused(value):
    sliders = SLIDER.replace(M=rs.logspace("M", 1, 10, 2))
    for name in ("device", "progress"):
        with pytest.raises(ParameterError, match=name):
            rs.sweep("stability", sliders, V_lp=1e-3, **{name: value})
    with pytest.raises(ParameterError):
        rs.sweep(value, sliders, V_lp=1e-3)
    with pytest.raises(ParameterError, match="parameter"):
        rs.continue_cycle(SLIDER, value, 1e8, 2e8, V_lp=1e-3)
