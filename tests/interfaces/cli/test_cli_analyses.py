"""``ratestate run``, ``stability`` and others: what they print, write and return."""

import dataclasses
import json
import math
import subprocess
import sys

import numpy as np
import pytest
import scenario_files
import xarray as xr
from command_line import call, refuse, succeed

import ratestate as rs
from ratestate import files
from ratestate.dynamics.verdict import verdict
from ratestate.interfaces.cli import run_scenario
from ratestate.scenario import load

LAB = f"""{scenario_files.SLIDER}M = "3000 kg/m^2"
V0 = "1 nm/s"
[loading]
V_lp = "0.1 mm/s"
steps = [{{ t = "50 ms", V_lp = "3.2 mm/s" }}]
[run]
t_end = "0.2 s"
"""
SWEEP = f"""{scenario_files.SLIDER.replace("900", "500")}[sweep]
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
    result = succeed(command, lab, *COMMANDS[command][0], "--json", "--out", out)
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


STEP = 'steps = [{ t = "50 ms", V_lp = "3.2 mm/s" }]'


def under_stress(drive, sigma="2 MPa", t_end="60 s", M="3000 kg/m^2"):
    """Changes of `LAB` to 0.1 mm/s, its normal stress changed by this line of [loading]."""
    own = [("2 MPa", sigma), ("3000 kg/m^2", M), ("0.2 s", t_end)]
    return [(STEP, drive), *((f'"{old}"', f'"{new}"') for old, new in own)]


def stress_step(t, sigma, *more):
    steps = ", ".join(f'{{ t = "{t}", sigma = "{sigma}" }}' for t, sigma in [(t, sigma), *more])
    return f"sigma_steps = [{steps}]"


#: under the aging law, at 0.5 mm/s K_c is 607.5 MPa/m
ABOVE_K_C = [('"900 MPa/m"', '"608.1 MPa/m"\nlaw = "aging"'), ("3.2 mm/s", "500 um/s")]
UNDISTURBED = [("900", "500"), ("0.1 mm/s", "3.2 mm/s"), ("steps", "# steps")]
ABOUT = "Motion in the long run at V_lp = 100 um/s"
NOT_REACHED = "This run has not reached this motion"
#: what is asked -> changes of LAB, command, what is said of it, and what is not
SAID = {
    "run": (
        [],
        ["run"],
        ["At the end, 200 ms, after", "V_max 26.8682 mm/s", "cycles 6", "V_lp = 3.2 mm/s"],
        ["\x1b"],
    ),
    "stability": (
        [],
        ["stability"],
        ["Steady sliding at 3.2 mm/s is unstable", "907.2 MPa/m", "3.16228 mm/s"],
        [],
    ),
    "cycle": (
        [],
        ["cycle"],
        ["19.7649 ms", "3e-10", "0.0012347", "0.9706, 7.097e-09", "1.141 V_lp"],
        ["of the last cycle"],
    ),
    "branch": (
        [],
        ["branch", *BRANCH],
        ["V_lp from 3.162 mm/s to 3.3 mm/s", "3.16228 mm/s", "hopf", "start"],
        [],
    ),
    "branch from forces": (
        [("[slider]", "[slider]\narea = '20 cm^2'")],
        ["branch", "--parameter", "K", "--start", "1.8 MN/m", "--stop", "1.79 MN/m"],
        ["K from 1.79 MN/m to 1.8 MN/m"],
        [],
    ),
    # the motion under a speed or a normal stress that goes on varying is not known
    "sinusoid": (
        [("0.1 mm/s", "3.2 mm/s"), (STEP, 'sinusoid = { amplitude = "1 mm/s", period = "50 ms" }')],
        ["run"],
        ["Steady sliding at the mean speed, V_lp = 3.2 mm/s: ", "steady sliding is unstable"],
        ["vibration at", "in the long run"],
    ),
    "record": (
        [('V_lp = "0.1 mm/s"', ""), (STEP, "t = [0, 0.1, 0.2]\nV_lp = [1e-3, 2e-3, 2e-3]")],
        ["run"],
        ["At the end"],
        ["V_lp = ", "steady sliding"],
    ),
    "hold": (
        [('"0.1 mm/s"', '"3.2 mm/s"'), (STEP, 'steps = [{ t = "50 ms", V_lp = 0 }]')],
        ["run"],
        ["At the end"],
        ["V_lp = ", "steady sliding"],
    ),
    "oscillating stress": (
        under_stress('sigma_sinusoid = { amplitude = "0.1 MPa", period = "1 s" }'),
        ["run"],
        [
            "Steady sliding at V_lp = 100 um/s if normal stress stayed at its mean, sigma = 2 MPa "
            "(it goes on oscillating): K = 900 MPa/m is 1.499 times K_c = 600.3 MPa/m"
        ],
        ["in the long run"],
    ),
    # the verdict is at the last normal stress
    "higher stress": (
        under_stress(stress_step("50 ms", "4 MPa")),
        ["run"],
        [
            f"{ABOUT} and the last normal stress, sigma = 4 MPa, after a start at a tenth",
            "Stick-slip, a cycle",
            "K = 900 MPa/m is 0.7498 times K_c = ",
        ],
        [NOT_REACHED],  # though the run's own amplitude is over sigma(0)
    ),
    "the same stress in the end": (
        under_stress(stress_step("50 ms", "4 MPa", ("59 s", "2 MPa"))),
        ["run"],
        [f"{ABOUT}, after a start at a tenth of that speed (a run may start otherwise): Steady"],
        ["the last normal stress"],
    ),
    # runs that end elsewhere
    "another motion": (
        [*ABOVE_K_C, ("0.1 mm/s", "495 um/s"), ('"0.2 s"', '"100 s"')],
        ["run"],
        ["Stick-slip, a cycle every", NOT_REACHED, "A longer t_end, or another start, may reach"],
        [],
    ),
    "a swing below what rtol resolves": (
        [("3.2 mm/s", "1 mm/s"), ('"0.2 s"', '"2 s"')],
        ["run"],
        ["Steady sliding at 1 mm/s"],
        ["of the last cycle"],
    ),
    # limits
    "edge": (
        [('"3.2 mm/s"', "3.1622776601683795e-3")],
        ["stability"],
        ["Steady sliding at 3.162 mm/s is on the edge of stability"],
        ["is stable", "is unstable"],
    ),
    "strengthening": (
        [("b = 0.006", "b = 0.002")],
        ["stability"],
        [
            "K 900 MPa/m stiffness per area",
            "K_c none critical stiffness; stable at any stiffness",
            "K_c_qs none quasi-static critical stiffness; stable at any stiff",
        ],
        ["Pa/m critical"],
    ),
    "above the Hopf point": (  # V_lp/Dc/(2 pi), by eq. 5
        [],
        ["stability"],
        ["Hopf bifurcation; 50.93 Hz, if K were raised to K_c at this speed"],
        [],
    ),
    "below the Hopf point": (
        [("900 MPa/m", "950 MPa/m")],
        ["stability"],
        ["Hopf bifurcation; 50.93 Hz, if K were lowered to K_c at this speed"],
        [],
    ),
    "no mass": (
        [("3000 kg/m^2", "0 kg/m^2")],
        ["stability"],
        ["V_c none critical velocity; stable at any speed", "f_n none natural frequency; M = 0"],
        [" inf "],
    ),
    "rigid": ([('"900 MPa/m"', "inf")], ["stability"], ["stable at any speed"], []),
    "no cycle": (
        [("3.2 mm/s", "1 mm/s")],
        ["cycle"],
        ["No cycle is reached at V_lp = 1 mm/s, slip law: steady sliding"],
        [],
    ),
}


def changed(lab, changes):
    """Change the scenario in a file."""
    text = lab.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    lab.write_text(text)


@pytest.mark.parametrize(("changes", "command", "said", "unsaid"), SAID.values(), ids=SAID)
def test_the_report_says_what_the_slider_does(changes, command, said, unsaid, lab):
    changed(lab, changes)
    result = call(command[0], lab, *command[1:])
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    text = " ".join(result.stdout.split())
    assert [words for words in said if words not in text] == [], text
    assert [words for words in unsaid if words in text] == [], text
    assert [path.name for path in lab.parent.iterdir()] == ["lab.toml"]


@pytest.mark.parametrize("name", ["sinusoid", "record", "oscillating stress"])
def test_json_names_no_regime_of_what_goes_on_varying(name, lab):
    changed(lab, SAID[name][0])
    found = parse_strict(call("run", lab, "--json").stdout)
    assert found.get("verdict", {"regime": None})["regime"] is None
    assert ("verdict" in found) == (name != "record")


@pytest.mark.parametrize("command", ["run", "stability", "cycle"])
def test_the_verdict_is_printed(command, lab):
    expected = verdict(SLIDER, 3.2e-3)
    text = call(command, lab).stdout.rstrip("\n")
    about = (
        "Motion in the long run at V_lp = 3.2 mm/s, after a start at a tenth of that speed (a "
        "run may start otherwise)"
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


def test_the_last_cycle_is_told_over_the_stress_that_it_is_over(lab):
    ramp = 'sigma_steps = [{ t = "0.1 s", sigma = "3.2 MPa", ramp = "100 s" }]'
    changed(lab, [*under_stress(ramp, "4 MPa", "30 s"), ("[run]", '[run]\nV_start = "50 um/s"')])
    result = scenario_result(lab)
    amplitude = float(result.amplitude)
    text = call("run", lab).stdout
    assert 0.0 < amplitude < math.inf
    assert "of the last cycle, over sigma(0) = 4 MPa" in text
    assert f"tau over the last normal stress of its last cycle is {amplitude / 0.8:.4g}." in text


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_run_that_nothing_disturbs_says_so_once(options, lab):
    changed(lab, UNDISTURBED)
    result = succeed("run", lab, *options)
    (line,) = result.stderr.splitlines()
    assert line.startswith("warning: the run starts on steady sliding at V_lp = 3.2 mm/s, which is")
    assert "K = 500 MPa/m is below K_c = 907.2 MPa/m" in line
    assert line.endswith("V_start = '320 um/s'.")
    if not options:
        assert result.stdout.splitlines()[-1] == (
            "This run has not reached this motion, because it starts on steady sliding and nothing "
            'disturbs it: give another start, such as V_start = "320 um/s" in [run].'
        )
    changed(lab, [("[run]", '[run]\nV_start = "320 um/s"')])
    result = call("run", lab, *options)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "has not reached" not in result.stdout


@pytest.mark.parametrize("command", ["stability", "cycle", "run"])
def test_a_sweep_is_announced_in_one_line(command, lab):
    single = call("stability", lab)
    assert (single.exit_code, single.stderr) == (0, "")
    lab.write_text(f'{LAB}[sweep]\nfunction = "stability"\nK = [5e8, 6e8, 2e9]\nM = [100, 200]\n')
    result = call(command, lab)
    assert (result.exit_code, result.stderr) == (
        0,
        "computing the [sweep] of the file, 6 cases. For a single case remove [sweep]. To "
        "keep the cases in a store use ratestate sweep.\n",
    )


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_run_that_runs_away_is_written_and_drawn_up_to_there(options, lab, tmp_path):
    lab.write_text(LAB.replace('"3000 kg/m^2"', "0"))
    numbers, picture = tmp_path / "run.nc", tmp_path / "run.png"
    result = refuse("run", lab, "--out", numbers, "--plot", picture, *options)
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


def test_a_stable_slider_without_mass_and_without_a_cycle(lab):
    lab.write_text(LAB.replace("3000 kg/m^2", "0 kg/m^2"))
    result = call("cycle", lab)
    assert (result.exit_code, result.stdout) == (2, "")
    verdict = (
        "Steady sliding at 3.2 mm/s is stable against small disturbances. Without mass (M = 0) a"
    )
    assert result.stderr.startswith(f"error: no cycle is found.\n{verdict} large one")


def test_json_has_null_for_a_missing_cycle_and_infinite_limits(lab):
    lab.write_text(LAB.replace("3.2 mm/s", "1 mm/s").replace("t_end", "rtol = 1e-5\nt_end"))
    succeed("cycle", lab)
    found = parse_strict(call("cycle", lab, "--json").stdout)
    assert found["data_vars"]["period"]["data"] is None
    assert found["data_vars"]["multipliers_real"]["data"] == [None, None]
    lab.write_text(LAB.replace('"900 MPa/m"', "inf"))
    found = parse_strict(call("stability", lab, "--json").stdout)
    assert found["data_vars"]["V_c"]["data"] == "inf"
    assert found["attrs"]["scenario"]["slider"]["K"] == "inf"
    assert found["data_vars"]["eigenvalues_real"]["data"][1:] == ["-inf", "-inf"]


def test_output_of_the_file_is_for_run_alone(lab):
    lab.write_text(LAB + '[output]\nfile = "x.csv"\nplot = "x.png"\n')
    assert call("cycle", lab).exit_code == 0
    assert call("run", lab, "--out", "y.csv").exit_code == 0
    assert sorted(path.name for path in lab.parent.iterdir()) == ["lab.toml", "x.png", "y.csv"]


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


STABLE = LAB.replace('"3.2 mm/s"', '"1 mm/s"')


def test_the_response_command_prints_numbers_and_tables(lab):
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
    assert "computing the [sweep] of the file, 3 cases" in result.stderr
    title = "6 cases of frequency_response over K (3 from 900 MPa/m to 3 GPa/m), frequency (2 from"
    assert title in result.stdout


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
        "error: standard input cannot be used:\nline 1, x: is above all"
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
    monkeypatch.setattr("ratestate.machine.memory", lambda: 3e9)
    lab.write_text(LAB.replace("M = ", "# ").replace('V_lp = "0.1 mm/s"\nsteps', "#") + HUGE)
    with lab.open("a") as file:
        file.write(f"'{function}'\n")
    result = call(command, lab)
    assert (result.exit_code, result.stdout) == (2, ""), result.stderr
    _, error = result.stderr.splitlines()
    assert error.startswith("error: the results of 961,000,000 cases need 1")
    assert "Give a store (ratestate sweep FILE --store x.zarr)." in result.stderr


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
        (KeyboardInterrupt(), 130, "interrupted: no unfinished file is kept\n"),
        (MemoryError(), 2, "error: not enough memory. Ask for less at a time.\n"),
        (rs.SolverError("stopped at t = 3 s"), 2, "error: stopped at t = 3 s\n"),
    ],
)
def test_interrupts_and_errors_have_exit_codes(error, code, message, lab, monkeypatch):
    def end(*_):
        raise error

    monkeypatch.setattr("ratestate.scenario.run", end)
    result = call("cycle", lab, "--out", "x.nc")
    assert (result.exit_code, result.stderr) == (code, message)
    assert [path.name for path in lab.parent.iterdir()] == ["lab.toml"]


#: where errors go -> a command that says something there
LEFT = {subprocess.PIPE: ["init", "--list"], subprocess.STDOUT: ["stability", "lab.toml"]}


@pytest.mark.parametrize("errors", LEFT)
def test_a_closed_output_pipe_ends_the_command_without_an_error(errors, lab):
    command = [sys.executable, "-c", "from ratestate.interfaces.cli import main; main()"]
    arguments = [
        *LEFT[errors],
        *(["--json", "--out", "x.csv"] if "lab.toml" in LEFT[errors] else []),
    ]
    with subprocess.Popen(
        [*command, *arguments], stdout=subprocess.PIPE, stderr=errors, text=True
    ) as process:
        process.stdout.close()  # before anything is said, as of `2>&1 | head`
        if process.stderr:
            assert process.stderr.read() == ""
    assert process.returncode == 0
    if errors == subprocess.STDOUT:
        assert lab.with_name("x.csv").read_text().startswith("K_c [Pa/m],")


def test_colours_are_for_terminals(lab, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b[" in call("stability", lab).stdout
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in call("stability", lab).stdout
