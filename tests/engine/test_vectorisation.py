"""Whether loops over lanes are SIMD code: what is counted in compiled code, and what is said."""

import types
import warnings

import numba
import pytest

from ratestate.engine import compilation, jit
from ratestate.engine.rows import WIDTH
from ratestate.engine.vectorisation import is_vectorised
from ratestate.errors import RunWarning
from ratestate.friction.laws import LAWS
from ratestate.friction.user_law import named_law

LANES = """
import math

def advance(s, n):
    for l in range({width} * n):
        x = s[l]
        s[l] = {value}

def others(s, n):
    for l in range(n):
        s[l] = s[l] * s[l]
"""


def counted(value, function="advance"):
    """Products in this function of a module of lanes."""
    module = types.ModuleType("tiny_lanes")
    exec(LANES.format(value=value, width=WIDTH), module.__dict__)
    compiled = jit.kernel(getattr(module, function))
    compiled._cache.disable()
    compiled.compile("(float64[::1], int64)")
    return compiled._cache.products[""]


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="the compiler is off")
def test_a_call_of_a_function_keeps_a_loop_from_being_vectorised():
    alone, vectors = counted("x * x * x * math.lgamma(1.0 + x * x)")
    assert alone >= 3 > vectors
    assert not is_vectorised((alone, vectors))
    assert counted("x", "others") == (0, 0)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="the compiler is off")
def test_loops_over_whole_vectors_leave_nothing():
    """The vectors are those that the compiler takes: no product of single numbers is left."""
    long = " + ".join(f"x * {k}.5 * (x + {k}.0)" for k in range(30))  # (short loops are doubled)
    alone, vectors = counted(long)
    assert alone == 0
    assert vectors >= 30
    assert is_vectorised((alone, vectors))


def test_a_small_part_may_be_left():
    assert is_vectorised((49, 951))
    assert is_vectorised((0, 0))
    assert not is_vectorised((51, 949))


class Kernel:
    """One of which products of single numbers and of vectors are told."""

    def __init__(self, law, products):
        self._cache = types.SimpleNamespace(products={law.name: products})

    def __call__(self, law):
        return law


@pytest.fixture
def mine(monkeypatch):
    """A user's law, where none was warned of."""
    for name in ("_called", "_announced", "_slow"):
        monkeypatch.setattr(compilation, name, set())
    return named_law(type("Mine", (type(LAWS["aging"]),), {"name": "mine", "source": "its source"}))


def test_a_law_that_is_slow_is_named_once(mine):
    kernels = [Kernel(mine, (600, 7)) for _ in range(2)]
    compilation._announced.update((kernel, mine) for kernel in kernels)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        for kernel in (*kernels, *kernels):
            assert compilation.call(kernel, mine) is mine
    (warning,) = said
    assert warning.category is RunWarning
    text = str(warning.message)
    assert text.startswith(f"law {mine.name}: ")
    assert "is not vectorised" in text
    assert "math.log" in text


@pytest.mark.parametrize("case", ["vectorised", "built in", "loaded"])
def test_of_other_laws_nothing_is_said(mine, case):
    law = LAWS["aging"] if case == "built in" else mine
    kernel = Kernel(law, (7, 600) if case == "vectorised" else (600, 7))
    if case != "loaded":
        compilation._announced.add((kernel, law))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compilation.call(kernel, law) is law
