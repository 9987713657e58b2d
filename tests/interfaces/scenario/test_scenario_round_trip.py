"""Scenario to text to scenario, to Python, to result and back: always the same bits."""

import math

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate import Loading, ParameterError, SpringSlider, files
from ratestate.model.history import History
from ratestate.model.quantities import QUANTITIES
from ratestate.model.units import is_array, to_si
from ratestate.scenario import Output, Scenario, from_result, load, python, run, toml
from ratestate.scenario.as_toml import quantity
from ratestate.scenario.values import USUAL

SLIDER = SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3000)


@pytest.fixture(scope="module")
def again(tmp_path_factory):
    """A scenario, written to a file and read."""
    path = tmp_path_factory.mktemp("again") / "it.toml"

    def again(scenario):
        path.write_text(toml(scenario), "utf-8")
        return load(path)

    return again


def executed(scenario):
    """The result of a scenario's Python lines."""
    there: dict = {}
    exec(python(scenario), there)
    return there["result"]


def alike(x, y):
    """Whether two settings have the same bits."""
    if isinstance(x, Loading):
        names = ("t", "V", "rate", "t_last", "normal_stress")
        return all(alike(getattr(x, name), getattr(y, name)) for name in names)
    if isinstance(x, History) and isinstance(y, History):
        names = ("t", "start", "end", "amplitude", "period")
        return all(alike(getattr(x, name), getattr(y, name)) for name in names)
    if is_array(x) or is_array(y):
        return is_array(x) and is_array(y) and x.equals(y)
    if isinstance(x, np.ndarray):
        return np.array_equal(x, y, equal_nan=True)
    return x == y


def check(one, other):
    """Check that two scenarios are the same."""
    assert (one.function, one.slider, one.output) == (other.function, other.slider, other.output)
    assert one.settings.keys() == other.settings.keys()
    for key, value in one.settings.items():
        assert alike(value, other.settings[key]), key


positive = st.floats(1e-30, 1e30)
speeds = st.one_of(st.just(0.0), st.floats(1e-20, 1e3))
times = st.floats(1e-9, 1e9)


def usual(symbol):
    """Any size that a file takes."""
    low, high = USUAL.get(symbol) or USUAL[QUANTITIES[symbol].unit]
    return st.floats(low or 1e-12, high)


def axes(symbol):
    """A parameter: one value, a list, or an axis with even spacing."""
    one = usual(symbol)
    values = st.lists(one, min_size=1, max_size=5).map(
        lambda found: xr.DataArray(found, dims=symbol)
    )
    even = st.tuples(one, one, st.integers(2, 9)).map(lambda ends: rs.logspace(symbol, *ends))
    return st.one_of(one, one, values, even)


sliders = st.builds(
    SpringSlider,
    a=axes("a"),
    b=st.one_of(st.floats(-1e2, 1e2), axes("b")),
    Dc=axes("Dc"),
    sigma=axes("sigma"),
    K=st.one_of(st.just(math.inf), axes("K")),
    M=st.one_of(st.just(0.0), axes("M")),
    mu0=usual("mu0"),
    V0=usual("V0"),
    law=st.sampled_from(["slip", "aging"]),
)


@st.composite
def events(draw, last=speeds):
    """Steps, holds and ramps, some where the last one ends."""
    loading = Loading.constant(draw(speeds))
    for _ in range(draw(st.integers(0, 6))):
        t = float(loading.t[-1])
        if not loading.speed.ends_event or draw(st.booleans()):
            t = (t + draw(times)) * (1 + 1e-9)
        kind = draw(st.sampled_from(["step", "hold", "ramp"]))
        lasting = max(draw(times), 1e-9 * t)
        given_ = {"step": [draw(speeds)], "hold": [lasting], "ramp": [draw(speeds), lasting]}
        loading = getattr(loading, kind)(t, *given_[kind])
    return loading


@st.composite
def records(draw):
    """Rows with jumps."""
    t = [0.0]
    for _ in range(draw(st.integers(1, 8))):
        if len(t) > 1 and draw(st.booleans()):
            t.append(t[-1])
        t.append((t[-1] + draw(times)) * (1 + 1e-9))
    V, sigma = ([draw(kind) for _ in t] for kind in (speeds, usual("sigma")))
    return Loading.series(t, V, sigma=draw(st.sampled_from([sigma, None])))


@st.composite
def stressed(draw, loading, sigma):
    """A loading with steps, ramps and a sinusoid of normal stress, for a slider of this sigma."""
    if loading.normal_stress is not None or is_array(sigma):
        return loading
    lowest, t_last = float(np.min(sigma)), min(loading.t_last, 1e8)
    for _ in range(draw(st.integers(0, 3))):
        stress = loading.normal_stress
        t = 0.0 if stress is None else float(stress.t[-1])
        if stress is None or not stress.ends_event or draw(st.booleans()):
            t += (t_last - t) * draw(st.floats(1e-3, 0.3))
        target, lasting = draw(usual("sigma")), (t_last - t) * draw(st.floats(1e-3, 0.3))
        lowest = min(lowest, target)
        step = draw(st.booleans())
        loading = loading.sigma_step(t, target) if step else loading.sigma_ramp(t, target, lasting)
    if draw(st.booleans()):
        amplitude = lowest * draw(st.floats(0.0, 0.99))
        amplitude = amplitude if amplitude >= USUAL["Pa"][0] else 0.0
        loading = loading.sigma_sinusoid(amplitude, period=draw(usual("period")))
    return loading


sinusoids = st.builds(
    lambda V_lp, share, period, turns: Loading.sinusoid(
        V_lp, share * V_lp, period=period, t_end=turns * period
    ),
    st.floats(1e-12, 1e3),
    st.just(0.0) | st.floats(1e-9, 1),
    times,
    st.floats(0.01, 5),
)


@st.composite
def simulations(draw):
    loading = draw(st.one_of(events(), records(), sinusoids))
    t_end = loading.t_last if np.isfinite(loading.t_last) else draw(st.floats(1e-3, 1e9))
    chosen = {"loading": loading, "t_end": t_end, "V_start": draw(usual("V_start"))}
    more = {
        "initial": st.fixed_dictionaries({"V": usual("V")}, optional={"theta": usual("theta")}),
        "times": st.one_of(
            st.lists(st.just(0.0) | st.floats(1e-3 * t_end, t_end), min_size=1, unique=True)
            .map(sorted)
            .map(np.array),
            st.just(np.linspace(0, t_end, 7)),
        ),
        "rtol": st.floats(1e-13, 0.1),
        "method": st.just("rodas5p"),
    }
    for key in draw(st.sets(st.sampled_from([*more]))):
        chosen[key] = draw(more[key])
    slider = draw(sliders)
    if np.isinf(slider.K).any():
        slider = slider.replace(K=1.0)
    if np.equal(slider.M, 0).any() and "initial" in chosen:
        del chosen["initial"]
    if loading.normal_stress is not None:  # which begins at the slider's
        slider = slider.replace(sigma=float(loading.normal_stress.start[0]))
    chosen["loading"] = draw(stressed(loading, slider.sigma))
    return Scenario("simulate", slider, chosen)


@st.composite
def others(draw):
    function = draw(st.sampled_from(["limit_cycle", "stability"]))
    chosen = {"V_lp": to_si("V_lp", draw(axes("V_lp")))}
    if function == "limit_cycle" and draw(st.booleans()):
        chosen["rtol"] = draw(st.floats(1e-12, 1e-2))
    return Scenario(function, draw(sliders), chosen, Output())


unhurried = settings(deadline=None, max_examples=20, suppress_health_check=list(HealthCheck))


@unhurried
@given(st.one_of(simulations(), others()))
def test_a_scenario_is_recovered_from_its_text(again, scenario):
    check(again(scenario), scenario)


@unhurried
@given(st.sampled_from(["Dc", "sigma", "K", "V_lp", "t_end", "M", "a", "dt"]), positive)
def test_quantities_keep_their_bits(symbol, x):
    text = quantity(symbol, x)
    assert to_si(symbol, eval(text)) == x
    assert len(text) < 40 or not 1e-30 < x < 1e30


def simulation(loading, t_end, slider=SLIDER, **more):
    return Scenario("simulate", slider, {"loading": loading, "t_end": t_end, **more})


MASSES = SLIDER.replace(M=rs.logspace("M", 100, 1e4, 3))
RIGID = SLIDER.replace(M=0, law="aging", K=np.inf, V0=1e-9)
TWO_SPEEDS = to_si("V_lp", xr.DataArray([1e-3, 2e-3], dims="V_lp"))
SCENARIOS = {
    "holds, ramps": simulation(
        Loading.constant(1e-4).ramp(1, 1e-3, 0.5).step(1.5, 2e-3).step(2, 1e-3),
        3.0,
        RIGID,
        V_start=1e-5,
    ),
    "sinusoid": simulation(Loading.sinusoid(1e-3, 1e-4, frequency=3, t_end=1), 1.0, rtol=1e-5),
    "record": simulation(
        Loading.series([0, 0.3, 0.3, 1], [1e-3, 1e-3, 0, 2e-3]),
        0.9,
        initial={"theta": 1.0, "tau": 1.1e6},
        times=np.array([0.1, 0.5]),
    ),
    "long record": simulation(
        Loading.series(np.linspace(0, 1, 1500), np.linspace(1e-3, 2e-3, 1500) ** 2), 1.0
    ),
    "sweep": simulation(
        Loading.steps(1e-4, (0.1, to_si("V_lp", rs.logspace("V_lp", 1e-3, 1e-2, 2)))), 0.2, MASSES
    ),
    "sweep over t_end": simulation(
        Loading.constant(1e-3),
        to_si("t_end", xr.DataArray([0.1, 0.2], dims="t_end")),
        V_start=to_si("V_start", xr.DataArray([1e-3, 2e-3, 3e-3], dims="V_start")),
    ),
    "sweep over a sinusoid": simulation(
        Loading.sinusoid(TWO_SPEEDS, 1e-4, period=1, t_end=0.3), 0.3
    ),
    "cycle": Scenario("limit_cycle", SLIDER, {"V_lp": 5e-3, "rtol": 1e-7}),
    "cycles": Scenario(
        "limit_cycle",
        SLIDER.replace(law="aging", M=rs.logspace("M", 1e3, 1e4, 2)),
        {"V_lp": to_si("V_lp", rs.logspace("V_lp", 1e-3, 1e-2, 3))},
    ),
    "stability": Scenario("stability", SLIDER.replace(K=rs.logspace("K", 1, 2, 2)), {"V_lp": 1.0}),
    "response": Scenario(
        "frequency_response",
        SLIDER,
        {"V_lp": 1e-3, "frequency": to_si("frequency", rs.logspace("frequency", 1, 1e3, 1201))},
    ),
    "many": Scenario(
        "stability", SLIDER.replace(K=rs.logspace("K", 1e8, 1e9, 1500)), {"V_lp": 1e-3}
    ),
    "branch": Scenario(
        "continue_cycle", SLIDER, {"parameter": "V_lp", "start": 4e-3, "stop": 5e-3, "rtol": 1e-5}
    ),
    "branch in K": Scenario(
        "continue_cycle",
        SLIDER,
        {"parameter": "K", "start": 9e8, "stop": 8.8e8, "V_lp": 3.2e-3, "rtol": 1e-5},
    ),
}


#: of every function one, and what has most to keep
KEPT = ("long record", "sweep over a sinusoid", "cycles", "stability", "response", "branch")


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_scenario_is_recovered_from_its_result(name, again, tmp_path):
    scenario = SCENARIOS[name]
    result = run(scenario)
    check(from_result(result), scenario)
    if name in KEPT:
        files.write(result, tmp_path / "kept.nc")
        check(from_result(files.read(tmp_path / "kept.nc")), scenario)
    check(again(scenario), scenario)
    assert run(again(from_result(result))).identical(result)
    by_lines = executed(scenario)
    assert by_lines.equals(result)
    assert python(from_result(by_lines)) == python(scenario)  # with the same texts


@pytest.mark.parametrize("V", [0.0, -1e-3])
def test_a_start_at_rest_or_backwards_and_back(again, V):
    """Under friction that lets slip reverse, by its own name or by that of the law."""
    given = {"loading": Loading.constant(1e-6), "t_end": 0.08, "initial": {"V": V, "tau": -1.5e6}}
    heated = SLIDER.replace(law="flash-heating", friction_form=None, V_w=0.1, mu_w=0.2)
    for slider in (SLIDER.replace(friction_form="regularized"), heated):
        scenario = Scenario("simulate", slider, given)
        check(again(scenario), scenario)
    with pytest.raises(ParameterError, match=r"\[run\] initial\.V: '.*' must be > 0. Give a sp"):
        again(Scenario("simulate", SLIDER, given))


def test_the_scenario_of_a_part_of_a_sweep(again):
    whole = run(SCENARIOS["cycles"])
    part = whole.sel(M=1e4).isel(V_lp=[0, 2])
    scenario = from_result(part)
    assert scenario.slider.M == 1e4
    assert scenario.settings["V_lp"].values.tolist() == [1e-3, 1e-2]
    for name, found in run(again(scenario)).data_vars.items():
        np.testing.assert_array_equal(found, part[name])


def test_the_scenario_of_joined_results():
    """Coordinates that join results are their parameters."""
    runs = [rs.stability(SLIDER.replace(K=K), 1e-3).assign_coords(K=K) for K in (9e8, 8e8)]
    both = xr.concat(runs, "K", combine_attrs="override")
    assert from_result(both).slider.K.values.tolist() == [9e8, 8e8]
    assert from_result(both.isel(K=1)).slider.K == 8e8


WITHOUT_SPEED = '{"slider": {"a": 1, "b": 2, "Dc": 1, "sigma": 1, "K": 1}, "rtol": 1}'


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda r: None, "NoneType is not a result"),
        (lambda r: r.drop_attrs(), "a result with the title '' has no scenario"),
        (lambda r: r.assign_attrs(title="simulate"), "a result with the title 'simulate' has no"),
        (lambda r: r.assign_attrs(title="ratestate fit"), "a fit has no scenario. Fit the record"),
        (lambda r: r.assign_attrs(scenario="{"), "the attribute 'scenario' of the Dataset has b"),
        (lambda r: r.assign_attrs(scenario='{"slider": {}}'), "SpringSlider needs a, b"),
        (lambda r: r.assign_attrs(scenario=WITHOUT_SPEED), "is altered (TypeError"),
        (lambda r: r.drop_vars("M"), "has lost the values of 'M'"),
    ],
)
def test_results_without_a_scenario_are_refused(damage, message):
    with pytest.raises(ParameterError) as caught:
        from_result(damage(run(SCENARIOS["sweep"])))
    assert message in str(caught.value)


@pytest.mark.parametrize("function", [run, python, toml])
def test_a_result_in_place_of_its_scenario_is_refused(function):
    with pytest.raises(ParameterError, match="a Dataset is not a scenario"):
        function(rs.stability(SLIDER, 1e-3))


SAMPLE = xr.DataArray([1e3, 2e3], dims="sample")


ROWS = [xr.DataArray([1e-4, 2e-4], dims="row"), 1e-4, 2e-4, 3e-4]
#: what a result holds and no file: slider and settings
UNWRITTEN = {
    "speeds along rows": (
        SLIDER,
        {"loading": Loading.series([0.0, 1.0, 1.0, 3.0], ROWS), "times": np.array([3.0])},
    ),
    "speeds and stresses of samples": (
        SLIDER,
        {
            "loading": Loading.series(
                [0, 0.3, 1], [1e-3, 1e-6 * SAMPLE, 2e-3], sigma=[2e6, 2e6, 2e3 * SAMPLE]
            ),
            "times": np.array([0.1, 0.5]),
        },
    ),
    "times of each case": (
        SLIDER.replace(M=rs.logspace("M", 100, 1e3, 2)),
        {
            "loading": Loading.constant(1e-3),
            "times": xr.DataArray([[0.0, 0.1], [0.05, 0.2]], dims=("M", "time")),
        },
    ),
    "initial values": (
        SLIDER,
        {"loading": Loading.constant(1e-3), "initial": {"V": 1e-9 * SAMPLE}},
    ),
}


@pytest.mark.parametrize("name", UNWRITTEN)
def test_a_result_keeps_what_a_file_cannot_hold(name, tmp_path):
    slider, given = UNWRITTEN[name]
    t_end = 3.0 if name == "speeds along rows" else 0.9
    result = run(Scenario("simulate", slider, given | {"t_end": t_end}))
    if name == "initial values":
        files.write(result, tmp_path / "run.nc")
        result = files.read(tmp_path / "run.nc")
    assert run(from_result(result)).identical(result)
    if "sample" in result.dims:
        part = from_result(result.isel(sample=1))
        assert run(part).V_max.equals(result.V_max.isel(sample=1, drop=True))


@pytest.mark.parametrize(
    ("slider", "changes", "message"),
    [
        (SLIDER.replace(M=SAMPLE), {}, "M lies along sample"),
        (
            SLIDER,
            {"loading": Loading.steps(xr.DataArray([1, 2.0], dims="V_lp"), (1, 1.0))},
            "only the last speed of a loading",
        ),
        (SLIDER, {"initial": {"V": SAMPLE * 1e-6}}, "initial values cannot be swept"),
        (
            SLIDER,
            {"loading": Loading.series([0, 9], [SAMPLE, 1])},
            "the speeds of a record cannot be swept",
        ),
        (
            SLIDER,
            {"loading": Loading.sinusoid(2e3, SAMPLE, period=1, t_end=1)},
            "the amplitude of a sinusoid cannot be swept",
        ),
    ],
)
def test_what_a_file_cannot_hold_is_refused_and_written_as_python(slider, changes, message):
    chosen = {"loading": Loading.constant(1e-3), "t_end": 0.01} | changes
    scenario = Scenario("simulate", slider, chosen)
    with pytest.raises(ParameterError, match=message):
        toml(scenario)
    if "loading" not in changes:
        assert executed(scenario).equals(run(scenario))


def test_the_text_of_a_scenario_is_formatted():
    scenario = Scenario(
        "simulate",
        SLIDER.replace(M=rs.logspace("M", 100, 1e4, 3)),
        {
            "loading": Loading.constant("1 mm/s").step(1, "3.2 mm/s").hold(2, 1).ramp(3, 0, 0.5),
            "t_end": 10.0,
            "initial": {"theta": 1.0},
        },
        Output(file=None, plot=None),
    )
    assert toml(scenario) == (
        """\
# To do this: ratestate sweep FILE.toml

[slider]
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "2 MPa"
K = "900 MPa/m"
mu0 = 0.6
V0 = "1 um/s"
law = "slip"

[loading]
V_lp = "1 mm/s"
steps = [
    { t = "1 s", V_lp = "3.2 mm/s" },
    { t = "2 s", hold = "1 s" },
    { t = "3 s", V_lp = "0 m/s", ramp = "500 ms" },
]

[run]
t_end = "10 s"
initial = { theta = "1 s" }

[sweep]
function = "simulate"
M = [100.0, 1000.0, 10000.0]  # kg/m^2
"""
    )
    whole = python(scenario)
    assert '    Dc="10 um",\n' in whole
    assert '    M=xarray.DataArray([100.0, 1000.0, 10000.0], dims="M"),\n' in whole
    assert whole.partition('law="slip",\n)\n')[2] == (
        """\
loading = (
    rs.Loading.constant("1 mm/s")
    .step("1 s", "3.2 mm/s")
    .hold("2 s", "1 s")
    .ramp("3 s", "0 m/s", "500 ms")
)
result = rs.simulate(slider, loading, t_end="10 s", initial={"theta": "1 s"})
"""
    )


def test_a_long_call_of_python_has_an_argument_a_line():
    def lines(n):
        steps = [(1.0 + i, 2e-3 + 1e-3 * i) for i in range(n)]
        settings = {"loading": Loading.steps(1e-3, *steps), "t_end": 5.0}
        return python(Scenario("simulate", SLIDER, settings))

    two = 'rs.Loading.steps("1 mm/s", ("1 s", "2 mm/s"), ("2 s", "3 mm/s"))'
    assert f"\nloading = {two}\n" in lines(2)
    assert """
loading = rs.Loading.steps(
    "1 mm/s",
    ("1 s", "2 mm/s"),
    ("2 s", "3 mm/s"),
    ("3 s", "4 mm/s"),
)
""" in lines(3)
