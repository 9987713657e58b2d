"""Scenarios whose friction law is in a file of the user's."""

import functools

import pytest
from scenario_files import SLIDER
from scenario_problems import problems_of
from user_laws import MINE, PLAIN

import ratestate as rs
from ratestate import ParameterError
from ratestate.friction.laws import LAWS
from ratestate.scenario import from_result, load, loads, python, toml

TEXT = f"""{SLIDER}M = 3000
law_file = "mine.py"
m = 1.5

[loading]
V_lp = "1 mm/s"

[run]
t_end = "0.05 s"
"""


@pytest.fixture
def write(law_file, tmp_path):
    """Writes a scenario, changed by pairs of texts, beside the law file."""
    law_file(MINE)

    def written(*changes):
        text = TEXT
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "mine.toml"
        path.write_text(text)
        return path

    return written


problems = functools.partial(problems_of, load)


def test_the_slider_has_the_law_of_the_file(write, monkeypatch):
    path = write()
    monkeypatch.chdir("/")  # its path is relative to the scenario
    slider = load(path).slider
    assert slider.law.partition("@")[0] == "mine"
    assert slider.m == 1.5
    for law in ("mine", "Mine", slider.law):
        assert load(write(("law_file", f'law = "{law}"\nlaw_file'))).slider == slider
    swept = load(write(("[loading]", '[sweep]\nfunction = "stability"\nm = [1, 2]\n[loading]')))
    assert swept.slider.m.values.tolist() == [1.0, 2.0]


def test_problems_of_a_law_file_stand_beside_others(write, tmp_path):
    """And what may be right under that law is not."""
    of_law = "[run]\ninitial = { phi = 1 }"
    path = write(('"mine.py"', '"main.py"'), ("a = 0.003", "a = -0.003"), ("[run]", of_law))
    assert [line.partition(". ")[0] for line in sorted(problems(path))] == [
        "[slider] a: -0.003 must be > 0",
        f"[slider] law_file: law file {tmp_path / 'main.py'} does not exist",
    ]
    (tmp_path / "wrong.py").write_text(MINE.replace("p.Dc", "p.D"))
    (line,) = problems(write(('"mine.py"', '"wrong.py"')))
    assert line == (
        f"[slider] law_file: law 'mine', line 9 of {tmp_path / 'wrong.py'}: p.D is not a "
        "parameter. Add D to parameters, or take one of a, b, Dc, mu0, V0, m."
    )
    (line,) = problems(write(('"mine.py"', "3")))
    assert line.startswith("[slider] law_file: 3 is not the name of a file.")
    (line,) = problems(write(("m = 1.5\n", "")))
    assert "needs m, exponent of the state. Give a pure number such as 1.5." in line


def test_another_law_beside_the_file_is_refused(write):
    for table in ("slider", "sweep"):
        law = {"slider": ("law_file", 'law = "aging"\nlaw_file')}.get(
            table,
            ("[loading]", '[sweep]\nfunction = "stability"\nlaw = "aging"\nK = [1e9]\n[loading]'),
        )
        (line,) = problems(write(law))
        assert line.startswith(f"[{table}] law: 'aging' is not the law in 'mine.py'.")
    (line,) = problems(write(("law_file", 'law = "mine@12345678"\nlaw_file')))
    assert "[slider] law: 'mine@12345678' is not the law in 'mine.py'. The file has cha" in line


def test_a_file_given_comes_before_that_of_the_scenario(write, law_file):
    other = law_file(MINE.replace('name = "mine"', 'name = "other"'), "other.py")
    slider = load(write(('"mine.py"', '"gone.py"')), law_file=other).slider
    assert slider.law.startswith("other@")
    with pytest.raises(rs.MissingFileError, match=r"^law file none\.py"):
        load(write(), law_file="none.py")


def test_the_code_of_a_text_is_not_run(write, law_file, monkeypatch, tmp_path):
    """Nor that of a law that is known by its hash."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParameterError, match=r"'mine.py' is a file of code, which is run only if"):
        loads(TEXT)
    assert [law for law in LAWS if "@" in law] == []
    slider = loads(TEXT, law_file="mine.py").slider
    law_file("raise RuntimeError")
    assert loads(TEXT.replace("law_file", f'law = "{slider.law}"\nlaw_file')).slider == slider


def test_an_unknown_law_needs_its_file(write):
    (line,) = problems(write(('law_file = "mine.py"', 'law = "mine@12345678"'), ("m = 1.5", "")))
    assert line.startswith("[slider] law: 'mine@12345678' is the law of a user")
    assert line.endswith("law_file = 'mine.py'.")


def test_a_scenario_names_its_law_file(write, tmp_path):
    scenario = load(write())
    text, law = toml(scenario), scenario.slider.law
    assert f'law = "{law}"\n' in text
    assert f'law_file = "{tmp_path / "mine.py"}"\n' in text
    assert loads(text).slider == scenario.slider
    lines = python(scenario)
    assert f'rs.register("{tmp_path / "mine.py"}")\n' in lines
    made = {}
    exec(lines.partition("result =")[0], made)
    assert made["slider"] == scenario.slider


def test_a_scenario_names_the_class_of_its_law(law_file):
    made = {}
    exec(PLAIN, made)
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, law=made["Plain"])
    scenario = from_result(rs.stability(slider, 1e-3))
    assert f'law = "{slider.law}"  # a user\'s: law_file names' in toml(scenario)
    assert loads(toml(scenario)).slider == slider
    assert f"# {slider.law} is a user's law: register its class" in python(scenario)


def test_keys_follow_the_laws_that_are_known(write):
    """A state's name too: `initial` takes those of any law."""
    text = MINE.replace('"1.5")}', '"1.5")}\n    states = {"phi": ("b", "Dc")}')
    path = write(("[run]", "[run]\ninitial = { phi = 0.01 }"))
    assert "initial.phi: unknown key. Give one of V, theta, theta2, tau" in problems(path)[0]
    (path.parent / "mine.py").write_text(text)
    assert load(path).settings["initial"] == {"phi": 0.01}
