"""The compiler of the control against Python, and the code that it refuses."""

import linecache
import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some
from machine_control import Machine

from ratestate.engine.code import VECTOR
from ratestate.engine.compiler import kernel_text
from ratestate.engine.programs import Context
from ratestate.friction.functions import exp, expm1, log, log1p, sqrt

TWO, HALF = 2, 0.5


class Inner(NamedTuple):
    n: int
    items: np.ndarray  # (6,) int64


class Given(NamedTuple):
    x: np.ndarray  # (4,)
    k: np.ndarray  # (4,) int64
    table: np.ndarray  # (2, 3)
    cube: np.ndarray  # (2, 3, 4)
    wide: np.ndarray  # (3, 2 VECTOR)
    inner: Inner
    out: np.ndarray  # (8,)


class Pair(NamedTuple):
    first: float
    second: int


# ------------------------------------------------------------------------------ supported code


def arithmetic(run, n):
    x, y, i = run.x[0], run.x[1], run.k[0]
    run.out[0] = x + y * 3.0 - i / 4
    run.out[1] = -x * TWO + HALF - (i - n)
    run.out[2] = (i * 7 - 2) * n
    run.out[3] = (i * i) // 3 + (i * i) % 5
    run.out[4] = abs(x) - max(x, y, 0.25) + min(i, n, 3)
    run.out[5] = -i + True
    x += y
    x *= 2
    i -= 1
    run.out[6] = x - i
    run.out[7] -= 2.5
    return x < y


def functions(run, n):
    x = abs(run.x[0]) + 0.25
    run.out[0], run.out[1], run.out[2] = sqrt(x), float(n) / 3, int(run.x[1])
    run.out[3], run.out[4] = log(x), exp(-x)
    run.out[5], run.out[6] = expm1(x), log1p(x)
    run.out[7] = sqrt(2.0) + math.pi
    return True


def conditions(run, n):
    x, y, i = run.x[0], run.x[1], run.k[0]
    run.out[0] = x < y <= run.x[2] != x
    run.out[1] = float(x < 2.0 and y < 2.0) + 2.0 * float(i > 0 or n > 4) + float(not i)
    run.out[2] = (x if i > n else y) + (1 if x == y else 2)
    first, second = (x, i) if n & 1 == 1 else (y, n)
    run.out[3] = first + second
    run.out[4] = 0 < i < run.inner.items.shape[0] and run.inner.items[i] > 0
    run.out[5] = (x > y) == (i > n) or (x > y) > (i >= n) or (x <= y) < (i != n)
    if i > n:
        run.out[6] = 1.0
    elif i < n:
        run.out[6] = 2.0
        if x:
            run.out[6] = 4.0
    else:
        run.out[6] = 3.0
    return x >= y


def loops(run, n):
    total, count = 0.0, 0
    for i in range(1, run.x.shape[0], 2):
        total += run.x[i]
    for i in range(n & 7):
        if run.k[i & 3] > 3:
            break
        count += i
    while count < 20:
        count += 3
        if count & 1 == 1 and total > 0.5:
            break
    run.out[0] = 2.0 * total
    for a in range(2):
        for b in range(3):
            if b > run.k[a]:
                break
            run.out[1] += run.table[a, b]
        run.out[2] += b
    run.out[3], run.out[4] = total, count
    return False


def swapped(pair, by):
    first, second = pair
    return second, first + by


def sum_from(run, start):
    total = 0
    for i in range(start, run.inner.items.shape[0]):
        if run.inner.items[i] == 0:
            return total
        total += run.inner.items[i]
    return total


def add_to(run, at, x):
    run.out[at] += x


def tuples(run, n):
    pair = run.x[0], run.k[0]
    pair = (pair[0] + 1.0, pair[1])
    for _ in range(2):
        pair = (2.0 * pair[0], pair[1] + 1)
    a, b = swapped(pair, HALF)
    if n > 3:
        pair = (0.5, 4)
    made = Pair(second=n, first=a)
    run.out[0], run.out[1], run.out[2] = pair[0], pair[1], b
    run.table[n & 1] = b, made[0], made[1]
    add_to(run, 3, made[0])
    c, d = b, float(a)
    c, d = d, c
    run.out[4] = c - 2.0 * d
    run.out[5] = sum_from(run, 1) + sum_from(run, run.inner.n & 3)
    return a > b


def arrays(run, n):
    i, j = run.k[0] & 1, n & 1
    run.table[i, j] += run.cube[j, 2, i + 1]
    run.cube[i, j, 3] = run.table[i, 2]
    run.inner.items[run.inner.n & 3] = n
    items = run.inner.items
    items[5] *= 2
    run.out[0] = run.table.shape[1] + run.cube.shape[2]
    run.out[1] = run.table[i, j]
    return items[0] > 0


def vectors(run, n):
    for j in range(0, run.wide.shape[1], VECTOR):
        first, factor = run.wide[0, j : j + VECTOR], run.x[0]
        for i in range(2):
            first = first - factor * run.wide[i, j : j + VECTOR]
        run.wide[2, j : j + VECTOR] = first * run.x[1] + n
        run.wide[1, j : j + VECTOR] += 0.5
    i = 0
    run.out[i : i + VECTOR] = run.wide[2, i : i + VECTOR]
    return True


SHAPES = (4,), (4,), (2, 3), (2, 3, 4), (3, 2 * VECTOR), (6,), (8,)
TYPES = float, np.int64, float, float, float, np.int64, float


def record():
    """Return a record of zeros, and its arrays."""
    arrays = [np.zeros(*one) for one in zip(SHAPES, TYPES, strict=True)]
    *others, items, out = arrays
    return Given(*others, Inner(5, items), out), arrays


def bits(array):
    """Return the bytes of an array; NaN without its sign, which Python does not keep."""
    return np.where(np.isnan(array), np.nan, array).tobytes() if array.dtype == float else array


FLOATS = some.lists(some.floats(-8.0, 8.0), min_size=1, max_size=34)
INTS = some.lists(some.integers(-4, 5), min_size=1, max_size=14)


@pytest.mark.parametrize("level", [0, 2])
@pytest.mark.parametrize(
    "function",
    [arithmetic, functions, conditions, loops, tuples, arrays, vectors],
    ids=lambda f: f.__name__,
)
def test_results_equal_pythons(function, level):
    """Each statement and expression gives Python's bits, on random numbers.

    Logarithms and exponentials are the engine's own, and agree to rounding.
    """
    (ours, mine), (theirs, others) = record(), record()
    machine = Machine(function, ours, level)

    @given(FLOATS, INTS, some.integers(0, 9))
    def compare(floats, ints, n):
        for one, other in zip(mine, others, strict=True):
            one[...] = np.resize(floats if one.dtype == float else ints, one.shape)
            floats, ints = floats[::-1], ints[::-1]
            other[...] = one
        with np.errstate(all="ignore"):
            assert machine(n) == bool(function(theirs, n))
        for one, other in zip(mine, others, strict=True):
            if function is functions:
                np.testing.assert_allclose(one, other, rtol=2e-15, atol=0)
            else:
                np.testing.assert_array_equal(bits(one), bits(other))

    compare()


# ------------------------------------------------------------------------------ refused code


def power(run, n):
    return run.x[0] ** 2 > 0.0


#: bodies of functions -> the statement that is refused
REFUSED = {
    "return power(run, n)": "return run.x[0] ** 2 > 0.0",
    "return run.table[0] > 0.0": "return run.table[0] > 0.0",
    "return run.x[run.x[0]] > 0.0": "return run.x[run.x[0]] > 0.0",
    "total = 0; total += run.x[0]; return total > 0": "total += run.x[0]",
    "total = 0.0; total = 1.0, 2.0; return total > 0.0": "total = (1.0, 2.0)",
    "if n > 0: return True\n return True, False": "return (True, False)",
    "for _ in range(n): n += 1\n else: n += 1\n return n > 0": "for _ in range(n):",
    "for x in run.x: n += int(x)\n return n > 0": "for x in run.x:",
    "i = 0; run.out[i : i + 4] = 0.5; return True": "run.out[i:i + 4] = 0.5",
    "i = 0; run.out[i : i + VECTOR : 2] = 0.5; return True": "run.out[i:i + VECTOR:2] = 0.5",
    "i = 0; run.wide[i : i + VECTOR, 0] = 0.5; return True": "run.wide[i:i + VECTOR, 0] = 0.5",
    "i = 0; v = run.out[i : i + VECTOR]; v += 1.0; return True": "v += 1.0",
    "add_to(run, at=0, x=1.0); return True": "add_to(run, at=0, x=1.0)",
}


def written(body):
    """Return a function with this body, of which Python knows the source."""
    source = f"def refused(run, n):\n {body}\n"
    linecache.cache[body] = len(source), None, source.splitlines(keepends=True), body
    exec(compile(source, body, "exec"), globals(), names := {})
    return names["refused"]


@pytest.mark.parametrize("body", REFUSED)
def test_unsupported_code_is_refused(body):
    """The error has notes with the name of the function and the text."""
    # (of many kinds, as Python's own operators refuse; what is tested are the notes)
    with pytest.raises(Exception) as refused:  # noqa: PT011
        kernel_text(written(body), Context(record()[0]).layout())
    place = "power" if "power" in body else "refused"
    assert f"test_compiler.{place}: {REFUSED[body]}" in refused.value.__notes__


def test_a_function_that_may_end_without_a_return_is_refused():
    with pytest.raises(ValueError, match="zip"):
        kernel_text(written("if n > 0: return True"), Context(record()[0]).layout())


@pytest.mark.parametrize(
    "wrong",
    [np.zeros(4)[::2], np.zeros(4, np.float32), np.zeros(4, ">f8"), np.zeros(4, bool), 0.5, None],
    ids=["strided", "float32", "big-endian", "bool", "float", "None"],
)
def test_unsupported_fields_of_a_record_are_refused(wrong):
    with pytest.raises(TypeError):
        Context(record()[0]._replace(x=wrong))


def test_arrays_that_are_empty_or_cannot_be_written_to():
    given, _ = record()
    fixed = np.arange(4.0)
    fixed.flags.writeable = False
    context = Context(given._replace(x=fixed, out=np.zeros(0)))
    assert context.words[0] == fixed.ctypes.data
    assert context.words[1] == 4
    assert context.words[-1] == 0
