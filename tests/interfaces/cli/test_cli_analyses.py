"""``ratestate run``, ``stability`` and others: what they print, write and return."""

import dataclasses
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import call

import ratestate as rs
from ratestate import files
from ratestate.dynamics.verdict import verdict
from ratestate.interfaces.cli import run_scenario
from ratestate.scenario import load
from ratestate.scenario.scenario import FUNCTIONS
from ratestate.sweeps.calls import call_of
from ratestate.sweeps.solve import bytes_per_case, form_of

LAB = """
[slider]
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "2 MPa"
K = "900 MPa/m"
M = "3000 kg/m^2"
V0 = "1 nm/s"
[loading]
V_lp = "0.1 mm/s"
steps = [{ t = "50 ms", V_lp = "3.2 mm/s" }]
[run]
t_end = "0.2 s"
"""
SWEEP = """
[slider]
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "2 MPa"
K = "500 MPa/m"
[sweep]
function = "limit_cycle"
M = [0, "3000 kg/m^2"]
V_lp = ["1 mm/s", "3 mm/s", "10 mm/s"]
"""
SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3e3, V0=1e-9)
LOADING = rs.Loading.steps(1e-4, (0.05, 3.2e-3))
BRANCH = ["--start", "3.3 mm/s", "--stop", "3 mm/s"]
#: command -> its arguments, and the same through the Python API
COMMANDS = {
    "run": ([], lambda: rs.simulate(SLIDER, LOADING, 0.2)),
    "stability": ([], lambda: rs.stability(SLIDER, 3.2e-3)),
    "cycle": ([], lambda: rs.limit_cycle(SLIDER, 3.2e-3)),
    "branch": (BRANCH, lambda: rs.continue_cycle(SLIDER, "V_lp", 3.3e-3, 3e-3)),
}


@pytest.fixture
def lab(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lab.toml"
    path.write_text(LAB)
    return path


class Api(dict):
    """command -> what the Python API gives, computed once and only if it is needed."""

    def __missing__(self, command):
        self[command] = COMMANDS[command][1]()
        return self[command]


@pytest.fixture(scope="module")
def api():
    return Api()


def parse_strict(text):
    """The document of strict JSON."""

    def refuse(constant):
        raise AssertionError(f"{constant} is no JSON")

    return json.loads(text, parse_constant=refuse)


@pytest.mark.parametrize("command", COMMANDS)
def test_numbers_are_those_of_the_python_api(command, lab, api):
    out = lab.with_name("out.nc")
    result = call(command, lab, *COMMANDS[command][0], "--json", "--out", out)
    assert result.exit_code == 0, result.output
    assert result.stderr == f"wrote {out}\n"
    xr.testing.assert_identical(files.read(out), api[command])
    found = parse_strict(result.stdout)
    assert found["title"] == api[command].attrs["title"]
    assert found["ratestate"] == rs.__version__
    assert found["failed"] == 0
    assert found["attrs"]["scenario"]["slider"]["K"] == 9e8
    same = files.stored.split(api[command])
    assert found["data_vars"].keys() == {*same.data_vars}
    assert found["coords"].keys() == {*same.coords}
    for name, variable in (found["data_vars"] | found["coords"]).items():
        assert variable["attrs"]["units"] == same[name].attrs["units"]
        assert variable["dims"] == list(same[name].dims)
        given = np.array(variable["data"], same[name].dtype)
        np.testing.assert_array_equal(given, same[name])


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("run", ["At the end, 200 ms, after", "V_max 26.8682 mm/s", "cycles 6", "V_lp = 3.2 mm/s"]),
        ("stability", ["Steady sliding at 3.2 mm/s is unstable", "907.2 MPa/m", "3.16228 mm/s"]),
        ("cycle", ["19.7649 ms", "3e-10", "0.0012347", "0.9706, 7.097e-09", "1.141 V_lp"]),
        ("branch", ["V_lp from 3.162 mm/s to 3.3 mm/s", "3.16228 mm/s", "hopf", "start"]),
    ],
)
def test_tables(command, words, lab):
    result = call(command, lab, *COMMANDS[command][0])
    assert result.exit_code == 0, result.output
    assert result.stderr == ""
    assert "\x1b" not in result.stdout
    text = " ".join(result.stdout.split())
    for word in words:
        assert word in text
    assert sorted(path.name for path in lab.parent.iterdir()) == ["lab.toml"]


def test_numbers_of_a_cycle_stand_beside_their_own_errors(lab, api):
    rows = {line.split()[0]: line for line in call("cycle", lab).stdout.splitlines() if line}
    for name, error in (
        ("period", "error"),
        ("amplitude", "error"),
        ("V_max", "V_max_error"),
        ("V_min", "V_min_error"),
    ):
        assert f" {float(api['cycle'][error]):.0e} " in rows[name], name
    assert "e-" not in rows["fundamental"]


@pytest.mark.parametrize("command", ["run", "stability", "cycle"])
def test_the_verdict_is_printed(command, lab):
    expected = verdict(SLIDER, 3.2e-3)
    text = call(command, lab).stdout.rstrip("\n")
    about = (
        "What the slider does in the long run at V_lp = 3.2 mm/s, started at a tenth of that speed "
        "(a run may start otherwise)"
    )
    if command == "run":
        assert f"\n\n{about}:\n{expected.text}\nThis run has not reached this motion: the" in text
        sentences = (*expected.sentences, text.splitlines()[-1])
        expected = dataclasses.replace(expected, sentences=sentences)
    else:
        assert text.startswith(f"{expected.text}\n\n")
    found = parse_strict(call(command, lab, "--json").stdout)
    assert found["verdict"] == {"about": about, "regime": "quasi-harmonic", "text": expected.text}


def scenario_result(path):
    """The result of a scenario file, through the Python API."""
    return run_scenario.compute(load(path))


DRIVES = [
    ('sinusoid = { amplitude = "1 mm/s", period = "50 ms" }', "Steady sliding at the mean speed"),
    ('t = ["0 s", "0.1 s", "0.2 s"]\nV_lp = ["1 mm/s", "2 mm/s", "2 mm/s"]', ""),
    ('steps = [{ t = "50 ms", V_lp = 0 }]', ""),
]


@pytest.mark.parametrize(("drive", "about"), DRIVES)
def test_nothing_is_said_of_motion_under_a_varying_speed(drive, about, lab):
    speed = 'V_lp = "3.2 mm/s"\n' if "V_lp = [" not in drive else ""
    before, after = LAB.index("V_lp"), LAB.index("[run]")
    lab.write_text(f"{LAB[:before]}{speed}{drive}\n{LAB[after:]}")
    result = call("run", lab)
    assert result.exit_code == 0, result.output
    text = result.stdout
    assert "vibration at" not in text
    assert text.count("steady sliding is unstable") == text.count("V_lp = ") == len(about[:1])
    assert about in text
    found = parse_strict(call("run", lab, "--json").stdout)
    assert found.get("verdict", {"regime": None})["regime"] is None


def under_stress(drive, sigma="2 MPa", t_end="60 s", M="3000 kg/m^2"):
    """`LAB` at 0.1 mm/s, its normal stress changed by this line of [loading]."""
    text = LAB.replace('steps = [{ t = "50 ms", V_lp = "3.2 mm/s" }]', drive)
    text = text.replace('"2 MPa"', f'"{sigma}"').replace('"3000 kg/m^2"', f'"{M}"')
    return text.replace('"0.2 s"', f'"{t_end}"')


@pytest.mark.parametrize(
    ("before", "after", "motion", "ratio"),
    [
        ("2 MPa", "4 MPa", "Stick-slip, a cycle", 0.7498),
        ("4 MPa", "2.5 MPa", "Steady sliding at 100", 1.2),
    ],
)
def test_the_verdict_on_a_run_is_at_the_last_normal_stress(before, after, motion, ratio, lab):
    change = f'sigma_steps = [{{ t = "50 ms", sigma = "{after}" }}]'
    lab.write_text(under_stress(change, before))
    text = call("run", lab).stdout
    about = f"at V_lp = 100 um/s and the last normal stress, sigma = {after}, started at a tenth"
    assert about in text
    assert f"\n{motion}" in text
    assert f"K = 900 MPa/m is {ratio:.4g} times K_c = " in text
    assert verdict(SLIDER.replace(sigma=after), 1e-4).text in text
    assert "has not reached" not in text  # though the run's own amplitude is over sigma(0)
    end = scenario_result(lab).isel(time=-1)
    assert f"tau/sigma = {float(end.tau / end.sigma):.6g}" in text
    assert 0.4 < float(end.tau / end.sigma) < 0.7
    lab.write_text(under_stress(f'{change[:-1]}, {{ t = "59 s", sigma = "{before}" }}]', before))
    assert "the last normal stress, sigma" not in call("run", lab).stdout


def test_the_last_cycle_is_told_over_the_stress_that_it_is_over(lab):
    ramp = 'sigma_steps = [{ t = "0.1 s", sigma = "3.2 MPa", ramp = "100 s" }]'
    lab.write_text(under_stress(ramp, "4 MPa", "30 s") + 'V_start = "50 um/s"\n')
    result = scenario_result(lab)
    amplitude = float(result.amplitude)
    text = call("run", lab).stdout
    assert 0.0 < amplitude < math.inf
    assert "of the last cycle, over sigma(0) = 4 MPa" in text
    assert f"tau over the last normal stress of its last cycle is {amplitude / 0.8:.4g}." in text


def test_nothing_is_said_of_motion_under_a_normal_stress_that_goes_on_varying(lab):
    lab.write_text(under_stress('sigma_sinusoid = { amplitude = "0.1 MPa", period = "1 s" }'))
    text = call("run", lab).stdout
    *_, about, stable, inertia = text.rstrip("\n").splitlines()
    assert about == (
        "Steady sliding at V_lp = 100 um/s if normal stress stayed at its mean, sigma = 2 MPa (it "
        "goes on oscillating):"
    )
    assert stable.startswith("K = 900 MPa/m is 1.499 times K_c = 600.3 MPa/m")
    assert inertia.startswith("eta = ")
    assert parse_strict(call("run", lab, "--json").stdout)["verdict"]["regime"] is None


def test_a_run_that_runs_away_before_normal_stress_falls_says_so(lab):
    step = 'sigma_steps = [{ t = "50 s", sigma = "0.6 MPa" }]'
    lab.write_text(under_stress(step, "12 MPa", "60 s", "0 kg/m^2") + 'V_start = "0.11 mm/s"\n')
    result = call("run", lab)
    assert result.exit_code == 2
    assert "K = 900 MPa/m is 0.25 times K_c_qs = 3.6 GPa/m at the normal" in result.stderr
    assert "Steady sliding at 100 um/s.\nK = 900 MPa/m is 5 times K_c = 180 MPa/m" in result.stdout
    assert result.stdout.endswith("it ends where V grows without bound.\n")


UNDISTURBED = LAB.replace("900", "500").replace("0.1 mm/s", "3.2 mm/s").replace("steps", "# steps")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_run_that_nothing_disturbs_says_so_once(options, lab):
    lab.write_text(UNDISTURBED)
    result = call("run", lab, *options)
    assert result.exit_code == 0, result.output
    (line,) = result.stderr.splitlines()
    assert line.startswith("warning: the run starts on steady sliding at V_lp = 3.2 mm/s, which is")
    assert "K = 500 MPa/m is below K_c = 907.2 MPa/m" in line
    assert line.endswith("V_start = '320 um/s'.")
    if not options:
        assert result.stdout.splitlines()[-1] == (
            "This run has not reached this motion, because it starts on steady sliding and nothing "
            'disturbs it: give another start, such as V_start = "320 um/s" in [run].'
        )
    lab.write_text(f'{UNDISTURBED}V_start = "320 um/s"\n')
    result = call("run", lab, *options)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "has not reached" not in result.stdout


def test_a_sweep_of_runs_that_nothing_disturbs_says_so_once(lab):
    lab.write_text(f"{UNDISTURBED}[sweep]\nfunction = 'simulate'\nK = [5e8, 6e8, 2e9]\n")
    _, line = call("run", lab).stderr.splitlines()
    assert line.startswith("warning: in 2 of 3 cases the run starts on steady sliding")


@pytest.mark.parametrize("command", ["stability", "cycle", "run"])
def test_that_a_file_is_swept_is_said_in_one_line(command, lab):
    single = call("stability", lab)
    assert (single.exit_code, single.stderr) == (0, "")
    lab.write_text(f'{LAB}[sweep]\nfunction = "stability"\nK = [5e8, 6e8, 2e9]\nM = [100, 200]\n')
    result = call(command, lab)
    assert (result.exit_code, result.stderr) == (
        0,
        "the [sweep] of the file is swept, 6 cases. For the single slider take [sweep] out. To "
        "keep the cases in a store use ratestate sweep.\n",
    )


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_run_that_runs_away_is_written_and_drawn_up_to_there(options, lab, tmp_path):
    lab.write_text(LAB.replace('"3000 kg/m^2"', "0"))
    numbers, picture = tmp_path / "run.nc", tmp_path / "run.png"
    result = call("run", lab, "--out", numbers, "--plot", picture, *options)
    assert result.exit_code == 2
    *wrote, error, slider = result.stderr.splitlines()
    assert wrote == [f"wrote {numbers}", f"wrote {picture}"]
    end = float(files.read(numbers).time[-1])
    assert error.startswith(
        f"error: simulate stopped at t = {end:.9g} s (quasi_static_instability)"
    )
    assert error.endswith("set M to simulate the slip event.")
    assert slider.startswith("SpringSlider(")
    assert picture.read_bytes()[:4] == b"\x89PNG"
    if options:
        found = parse_strict(result.stdout)
        assert found["data_vars"]["status"]["data"] == 5
        assert found["verdict"]["regime"] == "conditionally stable"
    else:
        assert result.stdout.startswith(f"At the end, {1e3 * end:.6g} ms, after ")
        assert "has not reached" not in result.stdout


def test_a_run_that_ends_elsewhere_than_the_verdict_says_so(lab):
    """Aging law just above K_c: small steps settle, from a tenth of the speed it stick-slips."""
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K=1, M=3e3, law="aging")
    K = 1.001 * slider.K_c(5e-4)
    text = LAB.replace('"900 MPa/m"', f"{K!r}\nlaw = 'aging'").replace("0.1 mm/s", "495 um/s")
    lab.write_text(text.replace("3.2 mm/s", "500 um/s").replace("0.2 s", "100 s"))
    lines = call("run", lab).stdout.splitlines()
    assert any(line.startswith("Stick-slip, a cycle every") for line in lines)
    assert lines[-1].startswith("This run has not reached this motion: ")
    assert lines[-1].endswith("A longer t_end, or another start, may reach it.")


def test_the_last_cycle_is_called_no_limit_cycle(lab):
    lab.write_text(LAB.replace("3.2 mm/s", "1 mm/s"))  # a ring-down
    text = call("run", lab).stdout
    (row,) = (line.split() for line in text.splitlines() if line.startswith("frequency"))
    assert row[3:] == "frequency of oscillation; of the last cycle".split()
    assert "limit cycle" not in text
    (row,) = (line.split() for line in text.splitlines() if line.startswith("amplitude"))
    (drop,) = (line.split() for line in text.splitlines() if line.startswith("stress_drop"))
    stress = float(drop[1]) * {"kPa": 1e3, "Pa": 1.0}[drop[2]]
    assert stress == pytest.approx(2e6 * float(row[1]), rel=2e-5)
    lab.write_text(LAB.replace("3.2 mm/s", "1 mm/s").replace('"0.2 s"', '"2 s"'))
    assert "of the last cycle" not in call("run", lab).stdout  # below what rtol resolves


def test_on_the_edge_nothing_is_called_unstable(lab):
    lab.write_text(LAB.replace('"3.2 mm/s"', "3.1622776601683795e-3"))
    text = call("stability", lab).stdout.replace("unstable where K < K_c", "")
    assert "\nSteady sliding at 3.162 mm/s is on the edge of stability\n" in text
    assert "stable" not in text.replace("least stable mode", "")


def test_where_friction_does_not_weaken_no_stiffness_is_critical(lab):
    lab.write_text(LAB.replace("b = 0.006", "b = 0.002"))
    text = call("stability", lab).stdout
    assert re.search(r"\nK +900 MPa/m +stiffness per area *\n", text)
    assert re.search(r"\nK_c +none +critical stiffness; stable at any stiffness", text)
    assert re.search(r"\nK_c_qs +none +quasi-static critical stiffness; stable at any stiff", text)
    assert not re.search(r"-\d+\S* [MG]Pa/m", text)
    found = parse_strict(call("stability", lab, "--json").stdout)
    assert found["data_vars"]["K_c"]["data"] < 0.0


@pytest.mark.parametrize(("K", "change"), [("900 MPa/m", "raised"), ("950 MPa/m", "lowered")])
def test_the_hopf_frequency_is_told_in_hertz(K, change, lab):
    lab.write_text(LAB.replace("900 MPa/m", K))
    text = " ".join(call("stability", lab).stdout.split())
    frequency = f"{3.2e-3 / 1e-5 / (2 * math.pi):.4g} Hz"
    assert f"Hopf bifurcation; {frequency}, if K were {change} to K_c at this speed" in text


@pytest.mark.parametrize("area", ["area = '20 cm^2'", ""])
def test_a_branch_begins_with_a_value_of_the_whole_contact(area, lab):
    lab.write_text(LAB.replace("[slider]", f"[slider]\n{area}"))
    found = call("branch", lab, "--parameter", "K", "--start", "1.8 MN/m", "--stop", "1.79 MN/m")
    if area:
        assert found.exit_code == 0, found.output
        assert "K from 1.79 MN/m to 1.8 MN/m" in found.stdout
    else:
        assert found.exit_code == 2
        assert "give the area too, such as area = '20 cm^2'" in found.stderr


def test_a_stable_slider_without_mass_and_without_a_cycle(lab):
    lab.write_text(LAB.replace("3000 kg/m^2", "0 kg/m^2"))
    result = call("cycle", lab)
    assert (result.exit_code, result.stdout) == (2, "")
    verdict = (
        "Steady sliding at 3.2 mm/s is stable against small disturbances. Without mass (M = 0) a"
    )
    assert result.stderr.startswith(f"error: no cycle is found.\n{verdict} large one")
    table = call("stability", lab).stdout
    assert re.search(r"V_c +none +critical velocity; stable at any speed", table)
    assert re.search(r"f_n +none +natural frequency; M = 0", table)
    assert not re.search(r"\binf\b", table)


def test_a_cycle_that_is_none_and_limits_that_are_infinite(lab):
    lab.write_text(LAB.replace("3.2 mm/s", "1 mm/s").replace("t_end", "rtol = 1e-5\nt_end"))
    result = call("cycle", lab)
    assert result.exit_code == 0
    assert "No cycle is reached at V_lp = 1 mm/s, slip law: steady sliding" in result.stdout
    found = parse_strict(call("cycle", lab, "--json").stdout)
    assert found["data_vars"]["period"]["data"] is None
    assert found["data_vars"]["multipliers_real"]["data"] == [None, None]
    lab.write_text(LAB.replace('"900 MPa/m"', "inf"))
    found = parse_strict(call("stability", lab, "--json").stdout)
    assert found["data_vars"]["V_c"]["data"] == "inf"
    assert found["attrs"]["scenario"]["slider"]["K"] == "inf"
    assert found["data_vars"]["eigenvalues_real"]["data"][1:] == ["-inf", "-inf"]
    assert "stable at any speed" in call("stability", lab).stdout


@pytest.mark.parametrize("ending", ["csv", "zarr"])
def test_other_files(ending, lab, api):
    out = lab.with_name(f"out.{ending}")
    assert call("cycle", lab, "--out", out).exit_code == 0
    if ending == "zarr":
        xr.testing.assert_identical(files.read(out), api["cycle"])
    else:
        assert out.read_text() == files.csv_text(api["cycle"])


def test_output_of_the_file_is_for_run_alone(lab):
    lab.write_text(LAB + '[output]\nfile = "x.csv"\nplot = "x.png"\n')
    assert call("cycle", lab).exit_code == 0
    assert call("run", lab, "--out", "y.csv").exit_code == 0
    assert sorted(path.name for path in lab.parent.iterdir()) == ["lab.toml", "x.png", "y.csv"]


# ---------------------------------------------------------------------------------------- sweeps


def test_a_sweep_in_memory(lab):
    lab.write_text(SWEEP)
    result = call("run", lab, "--out", "x.nc", "--plot", "x.png", "--json")
    assert result.exit_code == 3, result.output
    slider = SLIDER.replace(K=5e8, V0=1e-6, M=xr.DataArray([0.0, 3e3], dims="M"))
    V_lp = xr.DataArray([1e-3, 3e-3, 1e-2], dims="V_lp")
    expected = rs.sweep("limit_cycle", slider, V_lp=V_lp)
    xr.testing.assert_identical(files.read("x.nc"), expected)
    found = parse_strict(result.stdout)
    assert found["failed"] == 3
    assert found["data_vars"]["message"]["data"][1] == ["", "", ""]
    again = call("run", "--from", "x.nc", "--out", "y.nc")
    assert again.exit_code == 3
    xr.testing.assert_identical(files.read("y.nc"), expected)
    text = again.stdout
    assert "6 cases of limit_cycle over M (2 from 0 kg/m^2 to 3000 kg/m^2), V_lp (3 from" in text
    assert "3 cycles, 3 failed (quasi static instability)" in text
    row = next(line.split() for line in text.splitlines() if line.startswith("amplitude"))
    smallest, largest = (float(f(expected.amplitude)) for f in (np.nanmin, np.nanmax))
    assert (float(row[1]), row.count("kg/m^2,")) == (pytest.approx(smallest, rel=1e-5), 2)
    assert f"{largest:.6g}" in row
    assert "  M = 0 kg/m^2, V_lp = 10 mm/s: quasi_static_instability: V grows" in text


def test_a_sweep_over_many_axes_has_no_picture(lab):
    lab.write_text(SWEEP + "a = [0.003, 0.004]\n")
    result = call("run", lab, "--plot", "x.png")
    assert result.exit_code == 2
    assert "over one or two axes, and this one has 3 (a, M, V_lp)" in result.stderr


STABLE = LAB.replace('"3.2 mm/s"', '"1 mm/s"')


def test_a_response(lab):
    """Its numbers, and its tables, in which changes are relative and phases in degrees."""
    lab.write_text(STABLE)
    arguments = [lab, "--frequency", "50 Hz, 0.1 kHz", "--frequency", "200 Hz"]
    result = call("response", *arguments, "--json", "--out", "x.nc", "--units", "frequency=kHz")
    assert (result.exit_code, result.stderr) == (0, "wrote x.nc\n")
    expected = rs.frequency_response(SLIDER, 1e-3, [50.0, 100.0, 200.0])
    shown = parse_strict(result.stdout)
    assert shown["coords"]["frequency"]["data"] == [0.05, 0.1, 0.2]
    assert (
        shown["data_vars"]["tau_by_sigma_real"]["data"]
        == expected.tau_by_sigma.real.values.tolist()
    )
    assert "verdict" not in shown
    assert call("run", "--from", "x.nc", "--out", "y.nc").exit_code == 0
    xr.testing.assert_identical(files.read("y.nc"), expected)
    lines = [line.split() for line in call("response", *arguments).stdout.splitlines()]
    assert [
        "resonance",
        f"{float(expected.resonance):.6g}",
        "Hz",
        "resonance",
        "frequency",
    ] in lines
    rows = [line for line in lines if line[:2] == ["100", "Hz"]]
    one = expected.sel(frequency=100.0)
    for row, given, size in zip(rows, ("V_lp", "sigma"), (1e-3, 2e6), strict=True):
        numbers = [float(x) for x in row[2:]]
        for i, (out, unit) in enumerate({"V": 1e-3, "tau": 2e6, "mu": 1.0}.items()):
            change = complex(one[f"{out}_by_{given}"]) * size / unit
            assert numbers[2 * i] == pytest.approx(abs(change), rel=6e-4)
            assert numbers[2 * i + 1] == pytest.approx(np.degrees(np.angle(change)), abs=0.06)


def test_the_frequencies_of_a_response(lab):
    """Those of the file, which another function passes over, or decades; many are thinned."""
    lab.write_text(STABLE)
    text = call("response", lab).stdout
    assert "\n181 frequencies from 1 Hz to 1 kHz, 16 of them shown\n" in text
    assert sum(" Hz " in line or " kHz " in line for line in text.splitlines()[1:]) == 34
    lab.write_text(STABLE + "frequency = '5 Hz'\n")
    assert "\nOne frequency, 5 Hz\n" in call("response", lab).stdout
    assert call("stability", lab).exit_code == 0
    assert "frequency" not in load(lab).settings
    refused = call("response", lab, "--plot", "x.png")
    assert (refused.exit_code, "shows several frequencies" in refused.stderr) == (2, True)
    axis = 'function = "frequency_response"\nfrequency = [5, "8 Hz"]\nK = [9e8, 2e9, 3e9]\n'
    lab.write_text(f"{STABLE}[sweep]\n{axis}")
    result = call("response", lab)
    assert "is swept, 3 cases" in result.stderr
    title = "6 cases of frequency_response over K (3 from 900 MPa/m to 3 GPa/m), frequency (2 from"
    assert title in result.stdout


# ------------------------------------------------------------------------------------------ again


@pytest.mark.parametrize(("command", "ending"), [("run", "zarr"), ("branch", "nc")])
def test_from_a_result_to_the_same_bits(command, ending, lab, api):
    first, second = (lab.with_name(f"{name}.{ending}") for name in ("first", "second"))
    files.write(api[command], first)  # as the command does
    result = call("run", "--from", first, "--out", second)
    assert result.exit_code == 0, result.output
    xr.testing.assert_identical(files.read(second), files.read(first))


# ------------------------------------------------------------------------------ what may go wrong


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "none.toml"], "error: none.toml does not exist"),
        (["run"], "give either a file or --from"),
        (["run", "lab.toml", "--from", "x.nc"], "give either a file or --from"),
        (["run", "--from", "none.nc"], "error: none.nc does not exist"),
        (["run", "--from", "lab.toml"], "ends in .nc or .zarr"),
        (["run", "--from", "x.csv"], "lacks the parameters"),
        (["cycle", "lab.toml", "--out", "x.txt"], "Give a name that ends in .nc, .csv or .zarr"),
        (["cycle", "lab.toml", "--plot", "x.nc"], "Give a name that ends in .png or .pdf"),
        (["cycle", "lab.toml", "--out", "no/x.nc"], "error: the folder of no/x.nc does not exist"),
        (["cycle", "lab.toml", "--out", "folder.nc"], "folder.nc is a folder, and is not replaced"),
        (["cycle", "lab.toml", "--out", "folder.zarr"], "holds files that are not of one result"),
        (["branch", "lab.toml", "--start", "1 mm/s"], "both are needed"),
        (["explore", "--port", "99999"], "--port"),
        (["explore", "--save", "x.html", "--port", "8765"], "--port is for serving the page"),
        (["explore", "--save", "x.html", "--no-browser"], "--no-browser is for serving the page"),
    ],
)
def test_what_cannot_be_done_is_found_before_the_work(arguments, message, lab, monkeypatch):
    def never(*_):
        raise AssertionError

    for folder in ("folder.nc", "folder.zarr"):
        lab.with_name(folder).mkdir()
    before = sorted(lab.parent.rglob("*"))
    for function, function in [*FUNCTIONS.items()]:
        monkeypatch.setitem(FUNCTIONS, function, function._replace(call=never))
    result = call(*arguments)
    assert result.exit_code == 2, result.output
    assert message in " ".join(result.stderr.split())
    assert "Traceback" not in result.output
    assert result.stdout == ""
    assert sorted(lab.parent.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--parameter", "Q", *BRANCH], "parameter = 'Q'"),
        (["--start", "1 mm", "--stop", "2 mm"], "start = '1 mm' is a length"),
        ([], "[sweep]: is missing. Give the parameter that the branch follows"),
    ],
)
def test_a_branch_of_nothing(arguments, message, lab):
    result = call("branch", lab, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="no folder that takes no files")
def test_who_cannot_write_hears_of_the_file_that_was_asked_for(lab):
    result = call("cycle", lab, "--out", "/proc/x.nc")
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("error: /proc/x.nc: cannot be written: ")
    assert "tmp" not in result.stderr


def test_an_error_of_reading_is_not_called_one_of_writing(lab, monkeypatch):
    def unreadable(*_, **__):
        raise PermissionError(13, "Permission denied", "lab.toml")

    monkeypatch.setattr("ratestate.scenario.load", unreadable)
    assert call("cycle", lab).stderr == "error: lab.toml: Permission denied\n"
    monkeypatch.setattr("pathlib.Path.exists", unreadable)
    result = call("run", "--from", "x.nc")
    assert result.stderr.startswith("error: x.nc cannot be read as a result: ")


def test_a_scenario_from_standard_input(lab):
    from_file = call("stability", lab, "--json").stdout
    result = call("stability", "-", "--json", input=LAB)
    assert (result.exit_code, result.stdout, result.stderr) == (0, from_file, "")
    record = "t [s],V [mm/s]\n0,1\n0.01,1\n"
    lab.with_name("here.csv").write_text(record)
    loading = '[loading]\nfile = "here.csv"\ncolumns = [1, 2]\n[run]\nt_end = "10 ms"\n'
    text = LAB.split("[loading]")[0] + loading
    assert call("run", "-", input=text).exit_code == 0
    result = call("run", "-", input="x = [")
    assert result.stderr.startswith("error: standard input is not valid TOML: line 1, 'x = [': ")
    result = call("cycle", "-", input="x = 1")
    assert result.stderr.startswith(
        "error: standard input cannot be used:\nline 1, x: stands above all"
    )
    result = call("run", "-", input="#" * (10**7 + 1))
    assert "standard input cannot be read: it has 10000001 bytes, more than" in result.stderr


HUGE = """
[sweep]
M = { from = 1, to = 2, n = 31_000 }
V_lp = { from = 1, to = 2, n = 31_000 }
function = """


@pytest.mark.parametrize(
    ("command", "function"), [("run", "simulate"), ("run", "stability"), ("cycle", "limit_cycle")]
)
def test_a_sweep_too_large_for_memory_is_refused_at_once(command, function, lab, monkeypatch):
    def never(*_, **__):
        raise AssertionError

    monkeypatch.setattr("ratestate.sweeps.sweep.sweep", never)
    lab.write_text(LAB.replace("M = ", "# ").replace('V_lp = "0.1 mm/s"\nsteps', "#") + HUGE)
    with lab.open("a") as file:
        file.write(f"'{function}'\n")
    result = call(command, lab)
    assert (result.exit_code, result.stdout) == (2, ""), result.stderr
    _, error = result.stderr.splitlines()
    assert error.startswith("error: the results of 961,000,000 cases take 1")
    assert "Use ratestate sweep FILE --store x.zarr" in result.stderr


def test_three_gigabytes_are_not_too_large(lab, monkeypatch):
    asked = call_of("limit_cycle", load(lab).slider, {"V_lp": rs.logspace("V_lp", 1, 2, 2)})[1]
    side = math.isqrt(3 * 10**9 // bytes_per_case(form_of(asked).specs))
    monkeypatch.setattr("ratestate.sweeps.sweep.sweep", bug)
    for n, message in ((side, "so much for that"), (side + 1, "at most 3 GB are kept in memory")):
        text = LAB.split("[loading]")[0] + HUGE.replace("31_000", str(n)) + "'limit_cycle'\n"
        lab.write_text(text)
        assert message in call("run", lab).stderr


def test_a_disk_that_is_full(lab, monkeypatch):
    def full(self, path, **_):
        path.write_text("half")
        raise OSError(28, "No space left on device")

    lab.with_name("x.nc").write_text("old")
    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    result = call("cycle", lab, "--out", "x.nc")
    assert result.exit_code == 2
    assert result.stderr == "error: x.nc: cannot be written: No space left on device\n"
    assert lab.with_name("x.nc").read_text() == "old"
    assert len([*lab.parent.iterdir()]) == 2


def test_a_part_of_a_branch_is_kept(lab, monkeypatch):
    monkeypatch.setattr("ratestate.dynamics.continuation.branch.MAX_POINTS", 5)
    result = call("branch", lab, *BRANCH, "--out", "x.nc")
    assert result.exit_code == 3
    assert "error: the branch ends at V_lp = " in result.stderr
    assert 1 < files.read("x.nc").sizes["point"] <= 6
    assert "A branch of" in result.stdout


def bug(*_, **__):
    raise ZeroDivisionError("so much for that")


def test_a_bug_is_told_and_its_traceback_shown_if_asked(lab, monkeypatch):
    monkeypatch.setattr("ratestate.scenario.run", bug)
    result = call("cycle", lab)
    assert result.exit_code == 1
    assert result.stderr == (
        "this is a bug in ratestate: ZeroDivisionError: so much for that\n"
        "Please report it, with what the same command says with --debug.\n"
    )
    for arguments in (
        ["--debug", "cycle", lab],
        ["cycle", "--debug", lab],
        ["cycle", lab, "--debug"],
    ):
        result = call(*arguments)
        assert result.exit_code == 1
        assert result.stderr.startswith("Traceback (most recent call last)")
        assert "in bug" in result.stderr


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (KeyboardInterrupt(), 130, "interrupted: no file is half written\n"),
        (MemoryError(), 2, "error: not enough memory. Ask for less at a time.\n"),
        (rs.SolverError("stopped at t = 3 s"), 2, "error: stopped at t = 3 s\n"),
    ],
)
def test_other_ends(error, code, message, lab, monkeypatch):
    def end(*_):
        raise error

    monkeypatch.setattr("ratestate.scenario.run", end)
    result = call("cycle", lab, "--out", "x.nc")
    assert (result.exit_code, result.stderr) == (code, message)
    assert [path.name for path in lab.parent.iterdir()] == ["lab.toml"]


@pytest.mark.parametrize("errors", [subprocess.PIPE, subprocess.STDOUT])
def test_a_reader_that_leaves_ends_it_quietly(errors, lab):
    command = [sys.executable, "-c", "from ratestate.interfaces.cli import main; main()"]
    arguments = ["stability", lab, "--json", "--out", "x.csv"]
    with subprocess.Popen(
        [*command, *arguments], stdout=subprocess.PIPE, stderr=errors, text=True
    ) as process:
        process.stdout.close()  # before anything is said, as of `2>&1 | head`
        if process.stderr:
            assert process.stderr.read() == "wrote x.csv\n"
    assert process.returncode == 0
    assert lab.with_name("x.csv").read_text().startswith("K_c [Pa/m],")


def test_colours_are_for_terminals(lab, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b[" in call("stability", lab).stdout
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in call("stability", lab).stdout
