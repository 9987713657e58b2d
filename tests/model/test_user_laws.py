"""Laws of users: registered from files and classes, and identified by their formulas."""

import os
import pickle
import subprocess
import sys
import types

import numpy as np
import pytest
from user_laws import CUBIC, MINE, PLAIN

import ratestate as rs
from ratestate.friction.laws import LAWS
from ratestate.laws import log

COMMON = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 9e8}


def test_a_law_file_works_like_a_built_in_law(law_file):
    name = rs.register(law_file(MINE))
    base_name, digest = name.split("@")
    assert base_name == "mine"
    assert len(digest) == 8
    assert rs.register(law_file(MINE)) == name  # the same formula is the same law
    slider = rs.SpringSlider(**COMMON, law="mine", m=1.0)
    aging = slider.replace(law="aging")
    assert slider.law == name
    assert not hasattr(aging, "m")
    assert slider.V_c == pytest.approx(aging.V_c, rel=1e-13)
    assert eval(repr(slider), {"SpringSlider": rs.SpringSlider}) == slider
    assert f'"law": "{name}"' in rs.stability(slider, 4e-3).attrs["scenario"]
    with pytest.raises(rs.ParameterError, match=r"needs m"):
        rs.SpringSlider(**COMMON, law="mine")


def test_steady_sliding_is_found_for_each_slider_of_a_sweep(law_file):
    """Steady psi from z + 0.1 z^3 = q, for many q at once, agrees with the closed form."""
    rs.register(law_file(CUBIC))
    q = rs.logspace("q", 0.1, 30.0, 7)
    sliders = rs.SpringSlider(**COMMON, law="cubic", q=q)
    z = np.array([np.real(r) for x in q.values for r in np.roots([0.1, 0, 1, -x]) if r.imag == 0])
    K_c = rs.stability(sliders.replace(M=0.0), 4e-3).K_c
    closed_form = (0.006 - 0.003) * 2e6 / 1e-5 * (1 + 0.3 * z**2)
    np.testing.assert_allclose(K_c, closed_form, rtol=1e-11)
    np.testing.assert_allclose(sliders.K_c_qs, closed_form, rtol=1e-11)


def test_a_parameter_may_be_corrected_in_the_file(law_file):
    """The parameter of another law with the same symbol is another quantity."""
    rs.register(law_file(CUBIC))
    edited = rs.register(
        law_file(CUBIC.replace('"offset", "> 0"', '"offset of the state", ">= 0"'))
    )
    assert rs.SpringSlider(**COMMON, law=edited, q=0.0).q == 0
    other = CUBIC.replace('"cubic"', '"other"').replace('"offset"', '"something"')
    with pytest.raises(
        rs.ParameterError, match="the name of its parameter 'q' is used for another quantity"
    ):
        rs.register(law_file(other))


def law_with(constant, helper, base, default=1.0, table=(1.0,)):
    """Return a law whose rate has factors from all kinds of references in a function."""

    class Mine(base):
        name = "mine"

        def evolution(self, V, theta, p, times=default):
            factor = constant * helper(1.0) * self.factor * times * table[0] * MODULE.G
            return -factor * V * theta / p.Dc * log(V * theta / p.Dc)

    return Mine


def base_with(factor):
    return type("Base", (rs.FrictionLaw,), {"factor": factor})


MODULE = types.ModuleType("a_module")
MODULE.G = 1.0


@pytest.mark.parametrize("changed", "constant helper base default table module".split())
def test_a_law_changes_with_its_references(changed, monkeypatch):
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


def test_a_law_file_changes_with_a_file_that_it_imports(law_file, tmp_path, monkeypatch):
    """The other law runs in another process, which does not continue the first law's store."""
    text = PLAIN.replace("import ratestate as rs", "import ratestate as rs\nfrom constant import G")
    path = law_file(text.replace("-V", "-G * V"))
    law_file("G = 1.0", "constant.py")
    monkeypatch.syspath_prepend(tmp_path)
    slider = rs.SpringSlider(**COMMON, law=rs.register(path))
    del sys.modules["constant"]
    assert slider.K_c_qs == pytest.approx(6e8, rel=1e-12)
    M, store = rs.logspace("M", 1, 10, 3), tmp_path / "s.zarr"
    for _ in range(2):  # the second continues it
        rs.sweep("stability", slider.replace(M=M), V_lp=1e-3, store=store, progress=False)
    law_file("G = 2.50", "constant.py")  # another length, so that Python compiles it again
    code = (
        "import sys, ratestate as rs; name = rs.register(sys.argv[1]); common = eval(sys.argv[2])"
    )
    code += "; slider = rs.SpringSlider(**common, law=name); print(name, slider.K_c_qs)"
    code += "; M = rs.logspace('M', 1, 10, 3); sweep = slider.replace(M=M)"
    code += "; rs.sweep('stability', sweep, V_lp=1e-3, store=sys.argv[3], progress=False)"
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    command = [sys.executable, "-c", code, path, repr(COMMON), store]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    name, K_c = done.stdout.split()
    assert name != slider.law
    assert float(K_c) == pytest.approx(2.5 * 6e8, rel=1e-12)
    assert done.returncode == 1
    assert "StoreError" in done.stderr


@pytest.mark.parametrize(
    "changes", [("/ p.Dc", "/ p.Dc * 1.0000000000000002"), ("p.Dc", "p.V0"), ("-V", "-2 * V")]
)
def test_a_law_changes_with_any_number_in_its_formula(law_file, changes):
    text = PLAIN.replace("p.Dc *", "p.Dc * rs.laws.expm1(p.V0 * p.Dc) *")  # a constant factor
    assert rs.register(law_file(text.replace(*changes))) != rs.register(law_file(text))


@pytest.mark.parametrize(
    "changes",
    [
        ('"1", "exponent of the state", "> 0", "1.5"', '"s", "a time", "> 0", "\'1.5 s\'"'),
        ('"> 0", "1.5")}', '">= 0", "1.5")}'),
        ('"1.5")}', '"1.5")}\n    states = {"phi": ("b", "Dc")}'),
        ('"1.5")}', '"1.5")}\n    form = "regularized"'),
    ],
)
def test_a_law_changes_with_its_parameters_states_and_form(law_file, changes):
    first = rs.register(law_file(MINE))
    assert rs.register(law_file(MINE.replace(*changes))) != first


def test_a_pickled_slider_contains_its_law(law_file, tmp_path):
    """Another process registers the law from its source, even if the file is removed."""
    path = law_file(MINE)
    slider = rs.SpringSlider(**COMMON, law=rs.register(path), m=1.5)
    path.unlink()
    law = LAWS[slider.law]
    assert pickle.loads(pickle.dumps(slider)) == slider
    assert LAWS[slider.law] is law  # not made again if it is registered
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


def test_a_law_that_is_not_registered_is_refused():
    with pytest.raises(rs.ParameterError, match=r"not registered. Register .*'mine.py'"):
        rs.SpringSlider(**COMMON, law="mine@00000000", m=1.0)


def test_files_and_values_that_are_not_laws(tmp_path):
    for path in (tmp_path, tmp_path / "none.py", "/dev/zero", "a\0b"):
        with pytest.raises(
            rs.ParameterError, match=rf"^law file {path} (cannot be read|does not exist)"
        ):
            rs.register(path)
    for value in (None, 3, dict):
        with pytest.raises(rs.ParameterError, match=r"Give a class that derives from"):
            rs.register(value)


@pytest.mark.parametrize(
    ("rate", "series"),
    [
        ("1 - x", (1 / 2, -1 / 6, 1 / 24)),
        ("-x * log(x)", (0.0, 0.0, 0.0)),
        ("-x * (log(x) + 0.5 * log(x) ** 2 + 0.6 * log(x) ** 3)", (-0.5, -0.6, 0.0)),
        ("2 * (1 - x)", None),  # h'(1) = -2
        ("1 - x * x", None),
        ("1.5 - 1.5 * x ** (2 / 3)", ()),
        ("where(x > 1, -x * log(x), 1 - x)", None),  # of one length, but without a series
        ("1 - x + 1e-9 * (V - V)", ()),
        ("1 - x * (1 + V / p.V0)", None),
        ("log(2) - x", None),
    ],
)
def test_laws_of_one_length_are_recognised(rate, series):
    """The parameters are rates -z + c2 z^2 + ... with z = ln(V theta/Dc), and c2, c3, ..."""

    class Any(rs.FrictionLaw):
        name = "any"

        def evolution(self, V, theta, p):
            x = V * theta / p.Dc
            return eval(rate, vars(rs.laws) | {"x": x, "V": V, "p": p})

    rs.register(Any)
    law = rs.SpringSlider(**COMMON, law="any").friction_law
    assert law.one_length == (series is not None)
    if series:
        np.testing.assert_allclose(law.series[: len(series)], series, atol=1e-14)


def test_a_name_means_the_law_registered_last(law_file):
    """Registering an earlier law once more makes it the last one."""
    first = rs.register(law_file(PLAIN))
    second = rs.register(law_file(PLAIN.replace("-V", "-2 * V")))
    assert rs.SpringSlider(**COMMON, law="plain").law == second
    assert rs.register(law_file(PLAIN)) == first
    assert rs.SpringSlider(**COMMON, law="plain").law == first


#: prints texts of all formulas and of the generated code, and the names of laws given as texts
PRINTED = """
import hashlib
from ratestate.engine.code import unit_text
from ratestate.engine.units import MarchUnits, ReturnUnits
from ratestate.friction.composition import composed, forms_of, under_varying_stress
from ratestate.friction.laws import LAWS

for name, law in LAWS.items():
    all_forms = [composed(law, form, damped) for form in forms_of(law) for damped in (False, True)]
    texts = [one.equations.text for one in all_forms]
    some = all_forms if name == "two-state-slip" else all_forms[:1]
    texts += [unit_text(one, MarchUnits, 4) for one in some]
    if name == "slip":
        texts += [unit_text(all_forms[1], ReturnUnits, 4)]
        texts += [unit_text(under_varying_stress(all_forms[1]), MarchUnits, 4)]
    print(name, *(hashlib.sha256(x.encode()).hexdigest()[:8] for x in texts))
for text in TEXTS:
    exec(text, own := {})
    print(own["rs"].register(own["Plain"]))
"""
#: changes of a law file that do not change its formula
NO_CHANGES = [
    ("return", "# a comment\n        return"),
    ("    name", '    """A docstring."""\n    label = "Mine"\n    source = "Me (2026)"\n    name'),
    ("class Plain", "x = 3\nclass Plain"),
    ("return -V", "minus = -V\n        return minus"),
    ("-V * theta / p.Dc", "-V * theta * (1 / p.Dc)"),
]


def test_laws_do_not_depend_on_the_process_nor_on_how_they_are_written():
    """Names, formulas and generated code are the same under any hash seed."""
    texts = [PLAIN, *(PLAIN.replace(old, new) for old, new in NO_CHANGES)]
    assert len({*texts}) == 1 + len(NO_CHANGES)
    command = [sys.executable, "-c", PRINTED.replace("TEXTS", repr(texts))]
    found = []
    for seed in ("0", "1"):
        environment = os.environ | {"PYTHONHASHSEED": seed}
        printed = subprocess.check_output(command, text=True, env=environment)
        found.append(printed.splitlines())
    assert found[0] == found[1]
    *formulas, name = found[0][: 1 - len(texts)]
    assert len(formulas) > 7
    assert found[0][len(formulas) :] == [name] * len(texts)
