"""Every template does what its comment says, and what physics says."""

import re
import shlex

import numpy as np
import pytest
from paths import TEMPLATES as FOLDER

import ratestate as rs
from ratestate.friction.closed_forms import omega_c
from ratestate.friction.laws import DEFAULT, one_length_laws
from ratestate.model.quantities import QUANTITIES
from ratestate.paper.parameters import (
    FIG2,
    FIG2_DURATION,
    FIG2_SPEEDS,
    FIG2_START,
    FIG3_M,
    FIG3_V_LP,
    FIG4,
    FIG4_K,
    FIG4_V_LP,
    FIG6,
    FIG6_SPEEDS,
)
from ratestate.scenario import TEMPLATES, loads, run, template
from ratestate.scenario.templates import LAW, commands, description, files_of


def of_template(name, function=None):
    """The scenario of a template."""
    return loads(template(name), function, folder=FOLDER)


def done(name):
    """The scenario of a template, and its result."""
    scenario = of_template(name)
    return scenario, run(scenario)


def test_each_file_is_a_template_or_its_data():
    files = {path.name for path in FOLDER.iterdir() if path.suffix not in (".py", "")}
    own = {name: set(files_of(name)) for name in TEMPLATES}
    assert files == set().union(*own.values())
    assert own.pop("record") == {"record.toml", "record.txt"}
    assert own.pop("recorded-loading") == {"recorded-loading.toml", "recorded-loading.csv"}
    assert own == {name: {f"{name}.toml"} for name in own}


def test_each_template_is_tested_here():
    tested = {name.removeprefix("test_") for name in globals() if name.startswith("test_")}
    assert {name.replace("-", "_") for name in TEMPLATES if name[:3] != "fig"} <= tested


@pytest.mark.parametrize("name", TEMPLATES)
def test_a_template_says_what_it_is_and_what_to_try(name):
    first = template(name).split("\n")[0]
    assert first == f"# {description(name)}."
    assert 20 < len(description(name)) <= 62
    assert all(len(line) <= 100 for line in template(name).split("\n"))
    many = any(value.ndim for value in swept(of_template(name)))
    tried = [shlex.split(command.partition("    ")[0]) for command in commands(name)]
    assert ("sweep" if many else "run") in {words[1] for words in tried}
    assert all({*words} & set(files_of(name)) for words in tried)
    assert all(re.search(r" {4,}\w.*\w$", command) for command in commands(name))


def test_each_template_has_its_law_filled_in():
    """In the file that users get; it is a law that needs no parameter of its own, as are others."""
    for name in TEMPLATES:
        text, law = template(name), of_template(name).slider.law
        assert "$" not in text
        assert law == LAW.get(name, DEFAULT)
        assert text.count(f'law = "{law}"') == (name != "million")
    others = re.search(r'^law = "aging" +# or (.*)$', template("lab"), re.MULTILINE)[1]
    found = others.replace('"', "").split(" or ")
    assert found == [law for law in one_length_laws() if law != "aging"]
    assert "Add --law slip,aging to compare laws" in template("record")


def swept(scenario):
    values = [*scenario.slider.values.values(), *scenario.settings.values()]
    loading = scenario.settings.get("loading")
    return [np.asarray(v) for v in values if hasattr(v, "dims")] + [
        np.zeros((1,) * (np.ndim(loading.V) - 1)) if loading else np.zeros(())
    ]


def test_templates_of_figures_are_the_papers():
    """What they compute is tested with the paper's figures."""
    fig2, fig3, fig4, fig6 = (of_template(name) for name in ("fig2", "fig3", "fig4", "fig6"))
    assert fig2.slider == FIG2
    loading, t_end = fig2.settings["loading"], fig2.settings["t_end"]
    assert (float(loading.V[0, 0]), loading.t.tolist()) == (FIG2_START, [0.0, 0.1])
    assert loading.V[:, -1].values.tolist() == FIG2_SPEEDS
    assert t_end - 0.1 == pytest.approx(FIG2_DURATION)
    assert np.diff(fig2.settings["times"]) == pytest.approx(2e-3)
    assert fig3.slider == FIG2.replace(M=rs.logspace("M", *FIG3_M))
    assert fig3.settings["V_lp"].identical(rs.logspace("V_lp", *FIG3_V_LP))
    assert fig4.slider.replace(K=FIG4.K) == FIG4
    assert fig4.slider.K.values.tolist() == FIG4_K
    assert fig4.settings["V_lp"].identical(rs.logspace("V_lp", *FIG4_V_LP, 51))
    assert fig6.slider.replace(K=FIG6.K, law="slip") == FIG6
    assert float(fig6.slider.K) == pytest.approx(float(FIG6.K), rel=1e-12)
    assert fig6.settings["loading"].V.tolist() == [*FIG6_SPEEDS]
    functions = {scenario.function for scenario in (fig3, fig4)}
    assert (functions, fig2.function, fig6.function) == ({"limit_cycle"}, *["simulate"] * 2)


def test_static_kinetic():
    _, result = done("static-kinetic")
    friction = result.mu
    assert float(friction[0]) == pytest.approx(0.35, abs=1e-9)
    assert 0.425 < float(friction.max()) < 0.435
    assert int(result.cycles) > 10
    late = friction[friction.time > 1.2]
    assert float(late.min()) == pytest.approx(0.31, abs=0.005)
    assert float(late.max()) == pytest.approx(0.37, abs=0.005)


def test_million():
    scenario = of_template("million")
    assert scenario.slider.M.size * scenario.settings["V_lp"].size == 10**6
    assert scenario.slider.K_c_qs > scenario.slider.K


def test_slide_hold_slide():
    scenario, result = done("slide-hold-slide")
    slider, mu = scenario.slider, result.mu
    before = float(mu.sel(time=9.9, method="nearest"))
    rests = {1.0: 11.0, 10.0: 40.0, 100.0: 160.0, 1000.0: 1200.0}
    peaks = [float(mu.sel(time=slice(end, end + 19)).max()) - before for end in rests.values()]
    growth = np.diff(peaks) / (slider.b * np.log(10))
    assert (growth > 0.8).all()
    assert (growth < 1.01).all()
    rest = mu.sel(time=slice(60.01, 159.99))
    assert (np.diff(rest) < 0).all()  # friction relaxes while the load point rests


def test_brake_map():
    scenario, result = done("brake-map")
    V_c = scenario.slider.V_c
    assert ((result.status == 0) == (result.V_lp > V_c)).transpose("V_lp", "sigma").all()
    assert (np.diff(V_c) < 0).all()  # the harder the pads press, the sooner it vibrates
    # a quasi-harmonic vibration at the natural frequency, where inertia rules
    fastest = result.isel(V_lp=-1)
    assert (abs(fastest.frequency / scenario.slider.f_n - 1) < 0.1).all()
    assert (fastest.fundamental > 0.9).all()
    assert (fastest.V_max < 3 * fastest.V_lp).all()


def test_stiff_rig():
    scenario, result = done("stiff-rig")
    slider, mu = scenario.slider, result.mu
    direct, steady = slider.a * np.log(10), (slider.a - slider.b) * np.log(10)
    slow = float(mu[0])
    fast = float(mu.sel(time=129.9, method="nearest"))
    up = float(mu.sel(time=slice(100, 130)).max()) - slow
    down = float(mu.sel(time=slice(130, None)).min()) - fast
    assert 0.94 * direct < up < direct
    assert -direct < down < -0.94 * direct
    assert fast - slow == pytest.approx(steady, rel=1e-6)
    assert float(mu[-1]) == pytest.approx(slow, abs=1e-6)


def test_recorded_loading():
    scenario, result = done("recorded-loading")
    slider = scenario.slider
    rows = np.genfromtxt(
        FOLDER / "recorded-loading.csv", delimiter=",", skip_header=1, usecols=(0, 1)
    )
    driven = np.trapezoid(rows[:, 1], rows[:, 0]) * 1e-6
    assert float(result.delta_lp[-1]) == pytest.approx(driven, rel=1e-12)
    resting = result.sel(time=slice(121, 179))
    assert (resting.V_load == 0).all()
    assert (np.diff(resting.mu) < 0).all()
    settled = slider.mu0 + (slider.a - slider.b) * np.log(10)  # at 10 um/s
    assert float(result.mu.sel(time=59.9, method="nearest")) == pytest.approx(settled, abs=1e-5)
    assert float(result.mu[-1]) == pytest.approx(settled, abs=2e-5)


def test_sinusoid():
    """The swing is 50 times that of slow changes, at the frequency of the critical stiffness."""
    scenario, result = done("sinusoid")
    slider, (call,) = scenario.slider, scenario.settings["loading"].calls
    V, amplitude, _, frequency = call.arguments.values()
    end = result.sel(time=slice(1400, None)).tau
    swing = float(end.max() - end.min()) / 2
    assert 45 < swing / (slider.sigma * (slider.b - slider.a) * amplitude / V) < 55
    omega = omega_c(V, a=slider.a, b=slider.b, Dc=slider.Dc)
    assert 2 * np.pi * frequency == pytest.approx(omega, rel=0.01)


def test_lab():
    """Stick-slip that heals in the rest and loses stress with speed."""
    scenario, result = done("lab")
    slider = scenario.slider
    assert not run(of_template("lab", "stability")).stable
    assert slider.K_c_qs == pytest.approx(12e9, rel=1e-12)  # as the comment says
    cycle = run(of_template("lab", "limit_cycle"))
    assert 0.05 < float(cycle.amplitude) < 0.15
    assert 5 < float(cycle.period) < 10
    assert float(result.amplitude) == pytest.approx(float(cycle.amplitude), rel=1e-3)
    windows = (result.tau.sel(time=slice(*ends)) for ends in ((205, 220), (10, 30), (141, 150)))
    faster, before, rested = (float((x.max() - x.min()) / slider.sigma) for x in windows)
    assert faster < before < rested - 0.02
    assert (np.diff(result.tau.sel(time=slice(60, 139.9))) < 0).all()


def test_brake():
    scenario, result = done("brake")
    slider, theory = scenario.slider, run(of_template("brake", "stability"))
    assert float(slider.eta(20e-3)) < 1 < float(theory.eta)
    assert slider.K_c(20e-3) < slider.K < slider.K_c(50e-3)
    assert 0.5 < float(result.frequency) / slider.f_n < 1
    early = result.tau.sel(time=slice(0, 0.00499))
    assert early.max() - early.min() < 1e-6 * slider.sigma
    assert 0.02 < float(result.amplitude) < 0.04


def test_fault():
    _, result = done("fault")
    cycle = run(of_template("fault", "limit_cycle"))
    assert float(result.cycles) == 4
    assert 0.1 < float(result.V_max) < 10  # earthquakes
    year = 365.25 * 86400
    assert 100 < float(cycle.period) / year < 250
    assert 1 / float(result.frequency) == pytest.approx(float(cycle.period), rel=1e-3)


def test_record():
    """The record is the scenario's run with noise, and a fit finds the parameters."""
    scenario, result = done("record")
    slider, record = scenario.slider, rs.read_lab(FOLDER / "record.txt")
    noise = record.friction - (result.tau / slider.sigma).interp(time=record.time)
    assert 2.2e-4 < float(noise.std()) < 2.4e-4
    assert abs(float(noise.mean())) < 3e-5
    fit = rs.fit(record, slider.replace(a=0.01, b=0.01, Dc="10 um", K="60 GPa/m"))
    for name in ("a", "b", "Dc", "K"):
        low, high = fit.interval.sel(parameter=name, level=0.95).values
        assert low < float(getattr(slider, name)) < high
        assert high / low < 1.1


@pytest.mark.parametrize("name", ["lab", "brake", "fault", "record"])
def test_starting_templates_comment_on_every_parameter(name):
    text = template(name)
    for line in text.split("[slider]\n")[1].split("\n[loading]")[0].strip().split("\n"):
        symbol = line.split(" = ")[0]
        assert re.search(r"#.*\w{3}", line) or symbol == "V0", line
        assert symbol in QUANTITIES or symbol == "law"
