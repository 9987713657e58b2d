"""Laws of users: registered from files and classes, checked, and kept apart by their source."""

import os
import pickle
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from user_laws import CUBIC, MINE, NUMBERS, PLAIN, SLOWED

import ratestate as rs

COMMON = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}


def test_a_law_file_works_like_a_built_in_law(law_file):
    name = rs.register(law_file(MINE))
    own, digest = name.split("@")
    assert own == "mine"
    assert len(digest) == 8
    assert rs.register(law_file(MINE)) == name  # the same source is the same law
    slider = rs.SpringSlider(**COMMON, law="mine", m=1.0)
    aging = slider.replace(law="aging")
    assert slider.law == name
    assert not hasattr(aging, "m")
    assert slider.V_c == pytest.approx(aging.V_c, rel=1e-13)
    assert eval(repr(slider), {"SpringSlider": rs.SpringSlider}) == slider
    run, its = (
        rs.simulate(one, rs.Loading.constant(4e-3), 0.05, V_start=4e-4) for one in (slider, aging)
    )
    assert float(run.tau[-1]) == pytest.approx(float(its.tau[-1]), rel=1e-9)
    assert f'"law": "{name}"' in run.attrs["slider"]
    with pytest.raises(rs.ParameterError, match=r"needs m, exponent of the state; .* such as 1.5"):
        rs.SpringSlider(**COMMON, law="mine")
    for function, call in (
        ("limit_cycle", lambda: rs.limit_cycle(slider, 4e-3)),
        ("hopf", lambda: rs.hopf(slider)),
    ):
        with pytest.raises(rs.ParameterError, match=rf"{function} needs .*: rate_partials_2"):
            call()


def test_steady_sliding_is_found_for_each_slider_of_a_sweep(law_file):
    """psi in steady sliding, z + 0.1 z^3 = q: solved for many q at once, and in closed form."""
    rs.register(law_file(CUBIC))
    q = rs.logspace("q", 0.1, 30.0, 7)
    sliders = rs.SpringSlider(**COMMON, law="cubic", q=q)
    z = np.array([np.real(r) for x in q.values for r in np.roots([0.1, 0, 1, -x]) if r.imag == 0])
    K_c = rs.stability(sliders.replace(M=0.0), 4e-3).K_c
    closed_form = (0.006 - 0.003) * 2e6 / 1e-5 * (1 + 0.3 * z**2)
    np.testing.assert_allclose(K_c, closed_form, rtol=1e-11)
    np.testing.assert_allclose(sliders.K_c_qs, closed_form, rtol=1e-11)


def test_a_parameter_may_be_corrected_in_the_file(law_file):
    """Of the law itself; another law's is another quantity."""
    rs.register(law_file(CUBIC))
    edited = rs.register(
        law_file(CUBIC.replace('"offset", "> 0"', '"offset of the state", ">= 0"'))
    )
    assert rs.SpringSlider(**COMMON, law=edited, q=0.0).q == 0
    other = CUBIC.replace('"cubic"', '"other"').replace('"offset"', '"something"')
    with pytest.raises(rs.ParameterError, match="its parameter 'q' is another quantity"):
        rs.register(law_file(other))


def test_a_law_may_be_written_for_numbers(law_file):
    """With functions of math and branches: the slip law, about another steady state."""
    for text in (NUMBERS, CUBIC):
        rs.register(law_file(text))
    q = rs.logspace("q", 0.1, 3.0, 5)
    common = COMMON | {"b": 0.006 * (1 + 0.1 * q), "q": q}
    numbers, arrays = (rs.SpringSlider(**common, law=law) for law in ("numbers", "cubic"))
    one, other = (rs.stability(slider, 4e-3) for slider in (numbers, arrays))
    for name in ("K_c", "V_c", "eigenvalues", "omega_c"):
        np.testing.assert_allclose(one[name], other[name], rtol=1e-12, err_msg=name)
    alone = rs.stability(numbers.replace(b=0.006, q=0.3), 4e-3)
    assert float(alone.K_c) == pytest.approx(
        float(rs.stability(arrays.replace(b=0.006, q=0.3), 4e-3).K_c), rel=1e-12
    )
    law = numbers.friction_law  # of which the engine compiles what was written
    assert law.rates.__wrapped__.__func__ is vars(type(law))["rates"]


def test_an_edited_law_is_another_one(law_file):
    """Sliders of the first go on by the first; the name is that of the last."""
    first = rs.SpringSlider(**COMMON, law=rs.register(law_file(MINE)), m=1.0)
    slower = MINE.replace("((e[0] - e[1]) / p[1],)", "((e[0] - e[1]) / p[1] / 2.0,)")
    slower = slower.replace("(-e[1],), (", "(-e[1] / 2.0,), (")
    slower = slower.replace("* e[1]) / p[1],)", "* e[1]) / p[1] / 2.0,)")
    edited = rs.register(law_file(slower))
    second = rs.SpringSlider(**COMMON, law="mine", m=1.0)
    assert second.law == edited != first.law
    assert second.K_c_qs == pytest.approx(0.5 * first.K_c_qs, rel=1e-12)
    assert rs.SpringSlider(**first.parameters) == first


def law_with(constant, helper, base, default=1.0, table=(1.0,)):
    """A class of laws whose rate is multiplied by what it refers to, in each way there is."""

    class Mine(base):
        name = "mine"

        def rates(self, v, w, psi, e, p, times=default):
            factor = constant * helper(1.0) * self.factor * times * table[0] * MODULE.G
            return (-factor * w * (v + psi[0]),)

        def rate_partials(self, v, w, psi, e, p):
            factor = constant * helper(1.0) * self.factor * default * table[0] * MODULE.G
            return (-factor * w * (v + psi[0] + 1.0),), (-factor * w,)

    return Mine


def base_with(factor):
    return type("Base", (rs.FrictionLaw,), {"factor": factor})


MODULE = types.ModuleType("a_module")
MODULE.G = 1.0


@pytest.mark.parametrize("changed", "constant helper base default table module".split())
def test_a_law_is_another_one_with_anything_that_it_refers_to(changed, monkeypatch):
    """With its own numbers."""
    plain = {"constant": 1.0, "helper": lambda x: x, "base": base_with(1.0)}
    others = {"constant": 2.0, "helper": lambda x: x + x, "base": base_with(2.0)}
    others |= {"default": 2.0, "table": np.array([2.0])}
    kind = law_with(**plain)
    before = rs.SpringSlider(**COMMON, law=kind)
    K_c = before.K_c_qs
    assert rs.register(law_with(**plain)) == before.law
    if changed == "module":
        monkeypatch.setattr(MODULE, "G", 2.0)
    else:
        kind = law_with(**plain | {changed: others[changed]})
    after = rs.SpringSlider(**COMMON, law=kind)
    assert after.law != before.law
    assert after.K_c_qs == pytest.approx(2.0 * K_c, rel=1e-12)


def test_a_law_file_is_another_one_with_a_file_that_it_imports(law_file, tmp_path, monkeypatch):
    """In another process; a store made under the law before is not continued."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    text = PLAIN.replace("import ratestate as rs", "import ratestate as rs\nfrom constant import G")
    path = law_file(text.replace("-w", "-G * w").replace("- w", "- G * w"))
    code = (
        "import sys, ratestate as rs; name = rs.register(sys.argv[1]); common = eval(sys.argv[2])"
    )
    code += "; slider = rs.SpringSlider(**common, law=name); print(name, slider.K_c_qs)"
    code += "; M = rs.logspace('M', 1, 10, 3); sweep = slider.replace(M=M)"
    code += "; rs.sweep('stability', sweep, V_lp=1e-3, store=sys.argv[3], progress=False)"
    command = [sys.executable, "-c", code, path, repr(COMMON), tmp_path / "s.zarr"]
    names = set()
    for G, refused in ((1.0, False), (1.0, False), (2.5, True)):
        law_file(f"G = {G}", "constant.py")
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        name, K_c = done.stdout.split()
        names.add(name)
        assert float(K_c) == pytest.approx(G * 6e8, rel=1e-12)
        assert bool(done.returncode) == refused, done.stderr
        assert ("StoreError" in done.stderr) == refused
    assert len(names) == 2


def test_a_law_keeps_its_name_if_nothing_that_it_refers_to_changes():
    """Comments, objects elsewhere and the order of sets do not count; an open file is refused."""
    code = (
        "import ratestate as rs, decimal\nD = decimal.Decimal('2')\nKEYS = {'a', 'b', 'c', 'd'}\n"
    )
    code += PLAIN.partition("\n\n")[2].replace("(-w", "(-w * float(D) / 2 * len(KEYS) / 4")
    names = {
        subprocess.run(
            [sys.executable, "-c", code + end],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | {"PYTHONHASHSEED": seed},
        ).stdout
        for seed, end in (
            ("1", "\nprint(rs.register(Plain))"),
            ("2", "\nx=3;print(rs.register(Plain))"),
        )
    }
    assert len(names) == 1
    with Path(__file__).open() as file, pytest.raises(rs.ParameterError, match=r"TextIOWrapper"):
        rs.register(law_with(file, float, base_with(1.0)))


def test_a_class_is_registered_when_a_slider_takes_it(law_file):
    class Faster(rs.FrictionLaw):
        name = "faster"

        def rates(self, v, w, psi, e, p):
            return (-2.0 * w * (v + psi[0]),)

        def rate_partials(self, v, w, psi, e, p):
            return (-2.0 * w * (v + psi[0] + 1.0),), (-2.0 * w,)

        def rate_partials_2(self, v, w, psi, e, p):
            return (-2.0 * w * (v + psi[0] + 2.0),), (-2.0 * w,), (0.0,)

    slider = rs.SpringSlider(**COMMON, law=Faster)
    assert slider.law.startswith("faster@")
    assert slider.friction_law.orders == 2
    # twice as fast is half the distance
    half = rs.SpringSlider(**(COMMON | {"Dc": 5e-6}), law="slip")
    assert slider.K_c(1e-3) == pytest.approx(half.K_c(1e-3), rel=1e-9)


def test_a_slider_takes_its_law_along(law_file, tmp_path):
    """To a process that does not know it, by its source; the file may be gone."""
    path = law_file(MINE)
    slider = rs.SpringSlider(**COMMON, law=rs.register(path), m=1.5)
    path.unlink()
    (tmp_path / "slider").write_bytes(pickle.dumps(slider))
    code = "import pickle, sys; s = pickle.load(open(sys.argv[1], 'rb')); "
    code += "print(s.law, s.m, s.K_c(1e-3))"
    done = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "slider"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == [slider.law, "1.5", repr(slider.K_c(1e-3))]


def test_a_law_that_is_not_registered_is_not_looked_for(law_file):
    with pytest.raises(rs.ParameterError, match=r"not known here: register .*'mine.py'"):
        rs.SpringSlider(**COMMON, law="mine@00000000", m=1.0)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (
            "- w,), (-w,)",
            "- w,), (w,)",
            r"rate_partials, tuple 2 of 2: \(0.585.*differences \(-0.585",
        ),
        ("- w,), (-w,)", "+ w,), (-w,)", r"rate_partials, tuple 1 of 2: .*by differences"),
        ("(-w * (v + psi[0]),)", "(float('nan'),)", "rates must give a tuple of 1, finite"),
        ("(-w * (v + psi[0]),)", "-w * (v + psi[0])", "rates must give a tuple of 1, finite"),
        ("def rates(", "def rate(", "it has no method rates"),
        ("def rate_partials(", "def partials(", "it has no method rate_partials"),
        ('"plain"', '"slip"', "the name 'slip' is that of a built-in law"),
        ('"plain"', '"ruina"', "the name 'ruina' is that of a built-in law"),
        ('"plain"', '"Plain law"', "must be a name in small letters"),
        ("import ratestate as rs", "import nothing_like_it", "line 2: ModuleNotFoundError"),
        ("import ratestate as rs", "import ratestate as rs\n1 / 0", "line 3: ZeroDivisionError"),
        ("import ratestate as rs", "import ratestate as rs\nexit(3)", "line 3: SystemExit: 3"),
        ("class Plain", "class Plain(:", "line 4: SyntaxError"),
        (
            "    name",
            "    def __init__(self): 1 / 0\n    name",
            "cannot be made: ZeroDivisionError",
        ),
        ("    name", "    def __init__(self): exit(3)\n    name", "cannot be made: SystemExit: 3"),
        ("return (-w * (v", "exit(3); return (-w * (v", "cannot be tried: SystemExit: 3"),
        (
            "class Plain",
            "class E(Exception):\n    __str__ = None\nraise E()\nclass Plain",
            "line 6: E$",
        ),
        (
            "class Plain(rs.FrictionLaw)",
            "class T(type):\n    def __getattribute__(cls, name): 1 / 0\n\n"
            "class Plain(rs.FrictionLaw, metaclass=T)",
            "cannot be loaded, line 5: ZeroDivisionError",
        ),
        (
            "(rs.FrictionLaw)",
            "",
            "one class that derives from ratestate.FrictionLaw; it holds none",
        ),
    ],
)
def test_mistakes_in_a_law_file(law_file, old, new, said):
    """In a message of one or two lines."""
    assert old in PLAIN
    with pytest.raises(rs.ParameterError, match=said) as error:
        rs.register(law_file(PLAIN.replace(old, new), "plain.py"))
    assert len(str(error.value)) < 400


@pytest.mark.parametrize(
    ("method", "said"),
    [
        (
            "    def resistance_partials(self, v, w, psi, p):\n        return -1.0, (p[0],)\n",
            "friction must rise with the speed: dR/dv = -1",
        ),
        (
            "    def resistance_partials(self, v, w, psi, p):\n        return 1.0, (0.0,)\n",
            r"resistance_partials: \(1, 0\), by differences",
        ),
        (
            "    def steady_variables(self, p):\n        return (p[0],)\n",
            r"in steady sliding at V_ref the rates are \(-.*, not 0",
        ),
        (
            "    def steady_variables(self, p):\n        return (p[0] * float('nan'),)\n",
            r"in steady sliding at V_ref the rates are \(nan\), not 0",
        ),
        (
            '    parameters = {"K": rs.Parameter("1", "another")}\n',
            "its parameter 'K' is another quantity; rename it",
        ),
        (
            '    parameters = {"law": rs.Parameter("1", "another")}\n',
            "its parameter 'law' is another quantity; rename it",
        ),
        (
            '    parameters = {"theta2": rs.Parameter("s", "state 2", "> 0")}\n',
            "its parameter 'theta2' is another quantity; rename it",
        ),
        (
            '    parameters = {"q": rs.Parameter("m", "length", "> 0", "3 kg")}\n',
            r"the example of its parameter q is wrong: q = '3 kg' is a mass \[kg\]",
        ),
        ('    states = {"tau": "Dc"}\n', "its state 'tau' is another quantity, or no name"),
        ('    states = {"my state": "Dc"}\n', "its state 'my state' is another quantity, or no"),
        ("    states = {}\n", "it has no states"),
        (
            '    parameters = {"q": rs.Parameter("furlong", "length")}\n',
            "its parameter q has the unit 'furlong'",
        ),
        (
            "    def rate_partials_2(self, v, w, psi, e, p):\n        return (w,), (-w,), (0.0,)\n",
            "rate_partials_2, tuple 1 of 3",
        ),
        (
            "    def coefficients(self, V_ref, slider):\n        return (slider.nothing,)\n",
            "cannot be tried: AttributeError: .*nothing",
        ),
    ],
)
def test_mistakes_in_what_a_law_adds(law_file, method, said):
    with pytest.raises(rs.ParameterError, match=said) as error:
        rs.register(law_file(PLAIN + "\n" + method, "plain.py"))
    assert len(str(error.value)) < 500


def test_what_the_compiler_refuses_is_said_with_its_line(law_file):
    text = PLAIN.replace("(-w * (v + psi[0]),)", "(-w * (v + psi[0]) * psi.__len__(),)")
    slider = rs.SpringSlider(**COMMON, law=rs.register(law_file(text, "plain.py")))
    with pytest.raises(rs.CompilationError, match=r"the law plain@\w+ cannot be compiled: "):
        rs.simulate(slider, rs.Loading.constant(1e-3), 1e-4, V_start=1e-4)


def test_files_and_folders_that_are_no_laws(tmp_path):
    for path in (tmp_path, tmp_path / "none.py"):
        with pytest.raises(rs.ParameterError, match="cannot be read"):
            rs.register(path)
    for value in (None, 3, dict):
        with pytest.raises(rs.ParameterError, match=r"must be a class that derives from"):
            rs.register(value)


def test_a_law_of_one_length_has_its_series(law_file):
    """Without it limit cycles near K_c would not be its own; and it has the friction of eq. 1."""
    one = PLAIN.replace("    name", "    one_length = True\n    {}\n    name")
    cubic = one.replace("(-w * (v + psi[0]),)", "(-w * (v + psi[0]) * (1.0 + 0.5 * (v + psi[0])),)")
    cubic = cubic.replace(
        "-w * (v + psi[0]) - w,",
        "-w * (v + psi[0]) * (1.0 + 0.5 * (v + psi[0])) - w * (1.0 + v + psi[0]),",
    )
    cubic = cubic.replace("(-w,)", "(-w * (1.0 + v + psi[0]),)")
    assert rs.register(law_file(one.format("series = ()")))  # of which there are no more terms
    assert rs.register(law_file(cubic.format("series = (-0.5,)")))
    for series in ("", "series = (0.5,)"):
        with pytest.raises(rs.ParameterError, match=r"z = -0\.4 rates is 0\.32, .* z\^3 .* 0\.4"):
            rs.register(law_file(cubic.format(series)))
    more = "    def resistance(self, v, w, psi, p):\n        return v + p[0] * psi[0]\n"
    with pytest.raises(rs.ParameterError, match=r"one state, theta, and the friction of eq\. 1"):
        rs.register(law_file(one.format("") + more))


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("none.py", "No such file or directory"),
        ("/dev/zero", "it is not a file"),
        ("a\0b", "embedded null"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(path, why):
    with pytest.raises(rs.ParameterError, match=rf"^law file {path} cannot be read: .*{why}"):
        rs.register(path)


def test_a_name_is_that_of_the_law_registered_last(law_file):
    """Also where that was known before."""
    first, second = rs.register(law_file(PLAIN)), rs.register(law_file(PLAIN + "\n"))
    assert rs.SpringSlider(**COMMON, law="plain").law == second
    assert rs.register(law_file(PLAIN)) == first
    assert rs.SpringSlider(**COMMON, law="plain").law == first


def test_a_law_may_use_the_reference_speed_of_its_slider(law_file):
    """State that evolves the slower, the faster it slides beside V0; K_c in closed form."""
    name = rs.register(law_file(SLOWED))
    slider = rs.SpringSlider(**COMMON | {"M": 0.0}, law=name, V0=1e-3)
    for V in (1e-4, 2e-3):
        expected = (0.006 - 0.003) * 2e6 / 1e-5 / (1.0 + V / 1e-3)
        assert float(rs.stability(slider, V).K_c) == pytest.approx(expected, rel=1e-12)
        assert float(rs.stability(slider.replace(mu0=0.5), V).K_c) == pytest.approx(expected)
    for of_slider, text in (
        ("()", r"a method uses V0. Add of_slider = \('V0',\) to the class"),
        ('("K",)', r"of_slider = \('K',\) is not a tuple of parameters that every slider has"),
        ('"V0"', r"of_slider = 'V0' is not a tuple"),
    ):
        with pytest.raises(rs.ParameterError, match=text):
            rs.register(law_file(SLOWED.replace('("V0",)', of_slider)))
