"""Scenario files: they mean what the Python API means, and all problems are reported together."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenario_problems import problem_lines, problems_of

import ratestate as rs
from ratestate import ParameterError, SpringSlider
from ratestate.friction.laws import LAWS
from ratestate.model.units import to_si
from ratestate.scenario import load

SLIDER = {"a": "0.003", "b": "0.006", "Dc": '"10 um"', "sigma": '"2 MPa"', "K": '"900 MPa/m"'}
PARAMETERS = (
    "a, b, Dc, sigma, K, M, mu0, V0, law, friction_form, damping, alpha, area, V_w, mu_w, V_cut, "
    "c, b2, Dc2, V1, V2, normal_force, stiffness, mass, dashpot, law_file"
)
NAMES = ", ".join(LAWS)
LOG = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }'
TABLES = "[slider], [loading], [run], [sweep], [output]"
AXIS = '{ from = "100 kg/m^2", to = "1e5 kg/m^2", n = 4, scale = "log" }'
CYCLE = {"function": '"limit_cycle"', "M": AXIS, "V_lp": '"3.2 mm/s"'}
SIMULATE = {"function": '"simulate"', "M": AXIS, "V_lp": "1e-3", "t_end": '"10 s"'}


def toml(slider=SLIDER, sweep=CYCLE, more=""):
    """The text of a file; None leaves a key out."""
    tables = {"slider": slider, "sweep": sweep}
    lines = [more]
    for name, table in tables.items():
        lines += [f"[{name}]", *(f"{key} = {v}" for key, v in table.items() if v is not None)]
    return "\n".join(lines)


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    """Load a scenario from its text."""
    path = tmp_path_factory.mktemp("scenario") / "it.toml"

    def read(text):
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load(path)

    return read


def test_simulate_gets_a_loading_and_saved_times(read):
    sweep = SIMULATE | {"times": '[0.5, "1 s"]', "V_lp": '["1 mm/s", 0]', "V_start": '"1 um/s"'}
    scenario = read(toml(sweep=sweep | {"rtol": "1e-5"}))
    settings = scenario.settings
    assert settings.keys() == {"loading", "t_end", "times", "V_start", "rtol"}
    assert settings["times"].tolist() == [0.5, 1.0]
    assert (settings["t_end"], settings["V_start"], settings["rtol"]) == (10.0, 1e-6, 1e-5)
    run = rs.simulate(scenario.slider, **settings)
    assert run.sizes == {"M": 4, "V_lp": 2, "time": 2}
    assert (run.status == 0).all()


def test_times_are_no_axis(read):
    for times, expected in [
        ("[1]", [1]),
        ('"3 s"', [3]),
        ('{from = 0, to = "1 min", n = 3}', [0, 30, 60]),
    ]:
        scenario = read(toml(sweep=SIMULATE | {"times": times, "t_end": "60"}))
        assert type(scenario.settings["times"]) is np.ndarray
        assert scenario.settings["times"].tolist() == expected
    with pytest.raises(ParameterError, match=r"\[sweep\]: no key has several values"):
        read(toml(sweep=SIMULATE | {"times": "[1, 2]", "M": None}))


def test_sweep_overrides_the_slider_and_stands_in_for_it(read):
    sweep = CYCLE | {"K": '"1 GPa/m"', "law": '"aging"'}
    assert (
        read(toml(SLIDER | {"law": '"slip"'}, sweep)).slider
        == read(toml(SLIDER | {"K": None, "law": '"aging"'}, CYCLE | {"K": "1e9"})).slider
    )


UNITS = {
    "Dc": ["", " m", " um", " mm", "nm"],
    "sigma": ["", " Pa", " MPa", "bar"],
    "K": ["", " Pa/m", " MPa/m", " GPa/m"],
    "M": ["", " kg/m^2", " kg/m2", " g/cm^2"],
    "V_lp": ["", " m/s", " mm/s", "um/s", " m/hour"],
}


def spelled(x, unit):
    """A value as Python has it and as TOML does: a number, or a string with a unit."""
    return (f"{x!r}{unit}", f'"{x!r}{unit}"') if unit else (x, repr(x))


@st.composite
def values(draw):
    """(symbol, what the Python API is given, what the file says) of two to five symbols."""
    found = {}
    for symbol in draw(st.lists(st.sampled_from([*UNITS]), min_size=2, unique=True)):
        x = draw(st.floats(1e-6, 1e5))
        found[symbol] = spelled(x, draw(st.sampled_from(UNITS[symbol])))
    return found


@settings(deadline=None)
@given(values(), st.integers(2, 40), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_values_are_those_of_the_python_api(read, found, n, start, stop):
    text = {symbol: said for symbol, (_, said) in found.items()}
    sweep = CYCLE | {"mu0": f'{{from={start!r}, to={stop!r}, n={n}, scale="log"}}'}
    sweep["M"] = None
    sweep["V_lp"] = text.pop("V_lp", "1")
    scenario = read(toml(SLIDER | text, sweep))
    python = {"Dc": "10 um", "sigma": "2 MPa", "K": "900 MPa/m"}
    python |= {symbol: value for symbol, (value, _) in found.items() if symbol != "V_lp"}
    slider = SpringSlider(a=0.003, b=0.006, **python, mu0=rs.logspace("mu0", start, stop, n))
    assert scenario.slider == slider
    assert scenario.settings["V_lp"] == to_si("V_lp", found.get("V_lp", (1.0, ""))[0])


@settings(deadline=None)
@given(st.floats(-1e2, 1e2), st.floats(-1e2, 1e2), st.integers(2, 50))
def test_linear_axes(read, start, stop, n):
    b = read(toml(sweep=CYCLE | {"b": f"{{from={start!r}, to={stop!r}, n={n}}}"})).slider.b.values
    assert (b[0], b[-1], b.size) == (start, stop, n)
    rounding = 1e-15 * (abs(start) + abs(stop))
    np.testing.assert_allclose(b, np.linspace(start, stop, n), rtol=1e-14, atol=rounding)
    assert all(x == float(f"{x:.15g}") for x in b[1:-1])


def test_a_linear_axis_meets_the_numbers_it_should(read):
    for start, stop, n in [(-0.3, 0.3, 7), (0.0, 1.0, 11), (-0.1, 0.2, 31)]:
        axis = f'{{from={start}, to={stop}, n={n}, scale = "linear"}}'
        b = read(toml(sweep=CYCLE | {"b": axis})).slider.b.values
        step = 10 * (stop - start) / (n - 1)
        tenths = [round(10 * start + i * step, 9) for i in range(n)]
        assert b.tolist() == [float(f"{x / 10:.12g}") for x in tenths]
        assert 0.0 in b


def test_all_problems_are_reported_together(read):
    text = """
        loose = 1
        [slder]
        [slider]
        A = 0.003
        b = "0.006 m"
        Dc = ["10 um"]
        law = "slipp"
        V_lp = 1
        [sweep]
        function = "simulate"
        M = ["3 kg/m^2", "3 kg"]
        V_lp = { fro = 1, to = "3 m", scale = "logs" }
        rtol = 3
        t_end = 3
        times = [1, "1 h"]
    """
    lines = problems_of(read, text)
    expected = f"""\
loose: is above all tables. Give one of {TABLES}.
[slder]: unknown table. Give one of {TABLES}. Did you mean [slider]?
[slider] A: unknown key. Give one of {PARAMETERS}, such as a = 0.003. Did you mean a?
[slider] b: '0.006 m' is a length. Give a pure number such as 0.006.
[slider] Dc: a list of 1 makes an axis. Write it in [sweep], or give one value such as Dc = '10 um'.
[slider] law: 'slipp' is unknown. Give one of {NAMES}. Did you mean slip?
[slider] V_lp: is in the wrong table. Write it in [loading] or [sweep], \
such as V_lp = '3.2 mm/s'.
[slider] a: is missing. Give a pure number such as 0.003.
[slider] sigma: is missing. Give a stress such as '2 MPa'.
[slider] K: is missing. Give a stiffness such as '900 MPa/m'.
[sweep] M: mixes a mass per area and a mass. Give a mass per area such as '3000 kg/m^2'.
[sweep] V_lp.fro: unknown key. Give one of from, to, n, scale, such as {LOG}. Did you mean from?
[sweep] V_lp.scale: 'logs' is unknown. Give one of linear, log. Did you mean log?
[sweep] V_lp.from: is missing. Give a speed such as '3.2 mm/s'.
[sweep] V_lp.to: '3 m' is a length. Give a speed such as '3.2 mm/s'.
[sweep] V_lp.n: is missing. Give an integer from 2 to 1000000, such as 12.
[sweep] rtol: 3.0 is out of range. Give one number from 1e-13 to 0.1 such as 1e-6.
[sweep] times: reaches 3600 s, beyond t_end = 3 s. Extend t_end or drop the later times."""
    assert sorted(lines) == sorted(expected.splitlines())


#: changes of a good file -> the beginning of the line on it
MUTATED = [
    # an error of the Python API keeps its words
    ({"a": "-0.003"}, {}, "[slider] a: -0.003 must be > 0"),
    ({}, {"M": "[1, 2, -3]"}, "[sweep] M[2]: -3 kg/m^2 must be >= 0"),
    # values
    ({"a": "true"}, {}, "[slider] a: true is not one number"),
    ({"Dc": "0x" + "f" * 9999}, {}, "[slider] Dc: a huge integer is out of range"),
    ({"Dc": '"' + "9" * 10000 + ' m"'}, {}, "[slider] Dc: '9999 * is too long"),
    # keys
    ({'"a\\nb"': "1"}, {}, "[slider] 'a\\nb': unknown key"),
    # the function of [sweep]
    ({}, {"function": None}, "[sweep] function: is missing"),
    (
        {},
        {"function": '"limitcycle"'},
        "[sweep] function: 'limitcycle' is unknown. * mean limit_cycle?",
    ),
    ({}, {"V_lp": None}, "[sweep] V_lp: is missing"),
    ({}, {"t_end": "3"}, "[sweep] t_end: is not a parameter of the slider or of limit_cycle"),
    ({}, {"function": '"stability"', "rtol": "1e-6"}, "[sweep] rtol: is not a parameter of the"),
    ({}, {"M": None}, "[sweep]: no key has several values"),
    # lists
    ({}, {"rtol": "[1e-6]"}, "[sweep] rtol: a list of 1 is not one number"),
    ({}, {"M": "[]"}, "[sweep] M: is a list of 0 values"),
    # axes
    *(
        ({}, {"M": f"{{ from = 1, to = 2, n = {n} }}"}, f"[sweep] M.n: {said} cannot be the number")
        for n, said in (
            *(("1", "1"), ("2.0", "2.0"), ('"12"', "'12'"), ("true", "true")),
            *(
                ("[2]", "a list of 1"),
                ("10_000_000", "10000000"),
                ("0x" + "f" * 9999, "a huge integer"),
            ),
        )
    ),
    ({}, {"M": "{ from = 0, to = 2, n = 3, scale = 'log' }"}, "[sweep] M.from: 0 kg/m^2 must be >"),
    ({}, {"K": "{ from = 1, to = inf, n = 3 }"}, "[sweep] K.to: inf is not an end of an axis"),
]
SIMULATED = [
    ({"t_end": "inf"}, "[sweep] t_end: inf s must be finite"),
    (
        {"V_lp": "[1, 0]"},
        "[sweep] V_start: is missing, but at V_lp = 0 the slider does not slide steadily",
    ),
    ({"times": "[1, 11]"}, "[sweep] times: reaches 11 s, beyond t_end = 10 s"),
    ({"times": "[-1]"}, "[sweep] times[0]: -1 s must be >= 0"),
    ({"times": "[3]", "t_end": "[2, 4, 5]"}, "[sweep] times: reaches 3 s, beyond t_end"),
    ({"method": '"rodas5p"'}, "[sweep] method: is in the wrong table"),
]
BROKEN = [
    ("[slider]\na = 0.003\nDc = 10 um\n", "line 3, 'Dc = 10 um': Expected newline or end"),
    ("[slider]\na = \n", "line 2, 'a =': Invalid value"),
    ('[slider]\nDc = "10 um\n', "line 2, 'Dc = \"10 um': Illegal character"),
    ('[slider]\nDc = """10\n', 'line 2, \'Dc = """10\': Unterminated string'),
    ("x = " + "[" * 100_000, "brackets are nested too deeply"),
    ("x = " + "9" * 10_000, "an integer has thousands of digits"),
    (b'[slider]\nDc = "10 \xb5m"\n', "line 2 is not UTF-8"),
    ("a = 1\r[slider]", "line 1, 'a = 1\\r[slider]': Expected newline or end"),
    ("\0", "line 1, '\\x00': Invalid statement"),
    ("a = 1\r\nb = \r\n\r\n", "line 2, 'b =': Invalid value"),
]


REMEDY = r"(Give|Write|Leave|Call|Sort|Extend) .+[.?]"


def lines(read, text):
    with pytest.raises(ParameterError) as caught:
        read(text)
    assert caught.value.__cause__ is None
    assert all(len(line) < 350 for line in str(caught.value).splitlines())
    return [str(caught.value).splitlines()[0], *problem_lines(caught.value)]


def begins(beginning, line):
    """Whether a line has this beginning; * stands for anything."""
    return re.match(".*".join(map(re.escape, beginning.split(" * "))), line)


@pytest.mark.parametrize(("slider", "sweep", "beginning"), MUTATED)
def test_a_problem_has_its_line_and_remedy(read, slider, sweep, beginning):
    found = lines(read, toml(SLIDER | slider, CYCLE | sweep))
    assert found[0].endswith("it.toml cannot be used:")
    assert any(begins(beginning, line) for line in found[1:]), found
    form = re.compile(rf"\[\w+\]( ('.*'|[\w.\[\]]+))?: .+[^.]\. {REMEDY}")
    assert all(form.fullmatch(line) for line in found[1:]), found


@pytest.mark.parametrize(("sweep", "beginning"), SIMULATED)
def test_a_problem_of_simulate_has_its_line(read, sweep, beginning):
    found = lines(read, toml(sweep=SIMULATE | sweep))
    assert len(found) == 2
    assert begins(beginning, found[1]), found


@pytest.mark.parametrize(("text", "what"), BROKEN)
def test_a_file_that_is_not_toml_is_refused(read, text, what):
    (line,) = lines(read, text)
    assert f"it.toml is not valid TOML: {what}" in line
    assert line.endswith('such as a = 0.003 or Dc = "10 um".')


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ("[outptu]", "[outptu]: unknown table. * Did you mean [output]?"),
        ("[Slider]\na = 1", "[Slider]: unknown table. * Did you mean [slider]?"),
        ("a = 3", "a: is above all tables"),
        ("[[a]]", "a: is above all tables"),
        ("['x y']", "['x y']: unknown table"),
    ],
)
def test_unknown_tables_are_refused(read, more, line):
    found = lines(read, toml(more=more))
    assert len(found) == 2
    assert begins(line, found[1]), found


@pytest.mark.parametrize("text", ["", "slider = 3\nsweep = 3", "[[slider]]\n[[sweep]]"])
def test_an_empty_file_lacks_every_key(read, text):
    places = {line.split(": ")[0] for line in lines(read, text)[1:]}
    assert {f"[slider] {key}" for key in SLIDER} <= places
    if text:
        assert {"[slider]", "[sweep] function", "[sweep] V_lp", "[sweep]"} <= places
    else:
        assert places == {f"[slider] {key}" for key in SLIDER} | {"[loading] V_lp", "[run] t_end"}


def test_a_sweep_too_large_is_refused_before_it_takes_memory(read, monkeypatch):
    axes = dict.fromkeys(("a", "b", "Dc", "sigma", "K"), "{ from = 1, to = 2, n = 1_000_000 }")
    found = lines(read, toml(sweep=CYCLE | axes))
    assert len(found) == 2
    assert found[1].startswith("[sweep]: 4 M x 1000000 a x ")
    assert f"are {4 * 10**30} cases" in found[1]
    monkeypatch.setattr("ratestate.scenario.values.LONGEST", 3)
    wide = lines(read, toml(sweep=CYCLE | {"M": "[1, 1, 1, 1]"}))
    assert wide[1].startswith("[sweep] M: is a list of 4 values. Give 1 to 3 values")
