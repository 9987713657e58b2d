"""Machine code that is written by running formulas once: its functions, and the rates of laws."""

import ctypes

import mpmath as mp
import numpy as np
import pytest
from exact_functions import exact_function

from ratestate.engine.code import Code, Number, where
from ratestate.engine.machine_code import compiled, loaded
from ratestate.engine.vector_functions import Vectorised
from ratestate.friction.equations import Equations
from ratestate.friction.evaluation import evaluate
from ratestate.friction.expressions import exp
from ratestate.friction.laws import LAWS

WIDTHS = (1, 2, 4, 8)


def run(function, width, *columns):
    """What compiled code of a function of numbers gives for columns (n,), an array (m, n)."""
    code = Code(width)
    n = len(columns)
    given = []
    for k in range(n):
        at = code.write(f"getelementptr double, ptr %in, i64 {k * width}", Number)
        given.append(code.write(f"load {code.type(Number)}, ptr {at.name}, align 8", Number))
    results = function(*given)
    for k, one in enumerate(results):
        at = code.write(f"getelementptr double, ptr %out, i64 {k * width}", Number)
        code.lines.append(
            f"store {code.type(Number)} {code.text(Number, one)}, ptr {at.name}, align 8"
        )
    head, end = "define void @f(ptr %in, ptr %out) {", ["ret void", "}"]
    text = "\n".join([*code.declarations.values(), head, *code.lines, *end])
    address = loaded(compiled(text), ["f"])["f"]
    call = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(address)
    rows = np.stack(columns)
    found = np.empty((len(results), rows.shape[1]))
    for i in range(0, rows.shape[1], width):
        inside = np.ascontiguousarray(rows[:, i : i + width])
        out = np.empty((len(results), width))
        call(inside.ctypes.data, out.ctypes.data)
        found[:, i : i + width] = out
    return found


FUNCTIONS = [name for name in vars(Vectorised) if not name.startswith("_") and name != "where"]


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("width", WIDTHS)
def test_functions_are_accurate(name, width):
    """To a few units in the last place, of sizes from 1e-200 up to where e**x saturates."""
    sizes = np.concatenate([np.geomspace(1e-200, 1e-3, 24), np.geomspace(1e-3, 590.0, 72)])
    positive = name in ("log", "log1p", "sqrt")
    x = sizes if positive else np.concatenate([sizes, -sizes])
    (found,) = run(lambda one: [getattr(Vectorised, name)(one)], width, x)
    exact = exact_function(name)
    with mp.workdps(400):
        true = [exact(mp.mpf(float(one))) for one in x]
        off = [abs(mp.mpf(float(y)) - z) / abs(z) for y, z in zip(found, true, strict=True)]
        # near 0 the logarithm of what is near 1 is as good as 1 is rounded
        worst = (
            max(off)
            if name != "log"
            else max(o for o, one in zip(off, x, strict=True) if abs(one - 1.0) > 1e-3)
        )
    assert worst < 2e-15


@pytest.mark.parametrize("name", ["exp", "expm1", "softplus", "tanh", "asinh", "asinh_of_exp"])
def test_far_arguments_saturate_and_nan_stays(name):
    x = np.array([-1e300, -700.0, 700.0, 1e300, np.nan, -np.inf, np.inf, 0.0])
    (found,) = run(lambda one: [getattr(Vectorised, name)(one)], 4, x)
    assert np.isnan(found[4])
    assert np.isfinite(found[:4]).all()


@pytest.mark.parametrize("x", [0.0, -1.0])
def test_the_logarithm_of_no_positive_number_is_none(x):
    (found,) = run(lambda one: [Vectorised.log(one)], 2, np.array([x, 2.0]))
    assert np.isnan(found[0])
    assert found[1] == np.log(2.0)


def test_conditions_select():
    x = np.array([-2.0, 0.5, 3.0, np.nan])
    (found,) = run(lambda one: [where((one > 0.0) & ~(one >= 1.0), one * one, -one)], 4, x)
    np.testing.assert_array_equal(found, [2.0, 0.25, -3.0, np.nan])
    with pytest.raises(TypeError, match="condition"):
        run(lambda one: [one if one > 0.0 else -one], 1, x)


def test_an_instruction_is_written_once():
    code = Code(4)
    x = Number(code, "%x")
    assert (x + 1.0) * (x + 1.0) is (x + 1.0) * (x + 1.0)
    assert len(code.lines) == 2


def test_missing_functions_are_seen_before_they_are_called():
    code = compiled("define void @f() { ret void }")
    with pytest.raises(ImportError, match="lacks g"):
        loaded(code, ["f", "g"])


@pytest.mark.parametrize("name", [name for name in LAWS if hasattr(LAWS[name], "evolution")])
@pytest.mark.parametrize("width", WIDTHS)
def test_rates_of_laws(name, width):
    """As NumPy has them, to rounding, and the same bits in any lane."""
    law, rng, n = LAWS[name], np.random.default_rng(1), 64
    symbols = {"theta": ("b", "Dc"), "theta2": ("b2", "Dc2")}
    states = {state: symbols[state] for state in law.states}
    found = Equations(law, states, law.parameters)
    values = {"a": 0.01, "b": 0.014, "Dc": 1e-5, "mu0": 0.6, "V0": 1e-6, "b2": 0.003, "Dc2": 1e-4}
    values |= {"V_cut": 1e-8, "V_w": 0.1, "mu_w": 0.2}
    p = [float(one) for one in found.coefficients(2e-6, values)]
    v, *psi = 4.0 * rng.normal(size=(1 + len(found.psi), n))
    roots = [
        *found.rates,
        *(found.derivative(rate, found.v) for rate in found.rates),
        *(found.derivative(x, y) for x, y in zip(found.rates, found.psi, strict=True)),
    ]

    def written(v, *psi):
        known = {found.v: v, exp(found.v): Vectorised.exp(v)}
        known |= dict(zip(found.psi, psi, strict=True)) | dict(zip(found.constants, p, strict=True))
        return evaluate(roots, known, Vectorised)

    mine = run(written, width, v, *psi)
    np.testing.assert_allclose(mine, found.values(roots, v, psi, p), rtol=1e-11)
    order = rng.permutation(n)
    again = run(written, width, v[order], *(one[order] for one in psi))
    np.testing.assert_array_equal(again, mine[:, order])
