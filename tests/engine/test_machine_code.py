"""Machine code made by running formulas once: functions, and rates of laws."""

import ctypes
import subprocess
import sys

import mpmath as mp
import numpy as np
import pytest
from exact_functions import exact_function

from ratestate.engine import machine_code
from ratestate.engine.code import Code, Number, unit_text
from ratestate.engine.machine_code import compile_object, load_functions, target
from ratestate.engine.rows import LANES, WIDTH, rows_of
from ratestate.engine.units import MarchUnits, ReturnUnits, lane_units, point_units
from ratestate.friction import functions
from ratestate.friction.functions import CODE, where
from ratestate.friction.laws import LAWS

WIDTHS = (1, 2, 4, 8)


def run(function, width, *columns):
    """Return the results of a compiled function for columns (n,), an array (m, n)."""
    code = Code(width)
    results = function(*(code.load("%in", k * width) for k in range(len(columns))))
    for k, one in enumerate(results):
        code.store(one, "%out", k * width)
    head, end = "define void @f(ptr %in, ptr %out) {", ["ret void", "}"]
    text = "\n".join([head, *code.lines, *end])
    address = load_functions(compile_object(text), ["f"])["f"]
    call = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p)(address)
    rows = np.stack(columns)
    found = np.empty((len(results), rows.shape[1]))
    for i in range(0, rows.shape[1], width):
        inside = np.ascontiguousarray(rows[:, i : i + width])
        out = np.empty((len(results), width))
        call(inside.ctypes.data, out.ctypes.data)
        found[:, i : i + width] = out
    return found


#: functions with tests of their own
OTHERS = "exp_and_inverse", "rough_log2", "cosine"
FUNCTIONS = [name for name in vars(type(CODE)) if name[0] != "_" and name not in OTHERS]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_are_accurate(name):
    """A few units in the last place, from 1e-200 up to where e**x saturates."""
    sizes = np.concatenate([np.geomspace(1e-200, 1e-3, 16), np.geomspace(1e-3, 590.0, 40)])
    x = sizes if name in ("log", "log1p", "sqrt") else np.concatenate([sizes, -sizes])
    if name == "log":  # of what is near 1 it is as good as 1 is rounded
        x = x[abs(x - 1.0) > 1e-3]
    exact = exact_function(name)
    with mp.workdps(400):
        true = [exact(mp.mpf(float(one))) for one in x]
    for width in WIDTHS:
        (found,) = run(lambda one: [getattr(functions, name)(one)], width, x)
        off = [abs(mp.mpf(float(y)) - z) / abs(z) for y, z in zip(found, true, strict=True)]
        assert max(off) < 2e-15, width


@pytest.mark.parametrize("width", WIDTHS)
def test_compiled_exp_and_inverse_cosine_and_rough_log2_are_accurate(width):
    x = np.linspace(-8.0, 8.0, 64)
    exp, inverse = run(functions.exp_and_inverse, width, x)
    np.testing.assert_allclose([exp, inverse], np.exp([x, -x]), rtol=2e-15)
    (cosine,) = run(lambda one: [functions.cosine(one)], width, x)
    np.testing.assert_allclose(cosine, functions.cosine(x), rtol=0, atol=5e-16)
    (rough,) = run(lambda one: [functions.rough_log2(one)], width, 10.0 ** (35.0 * x))
    np.testing.assert_allclose(rough, functions.rough_log2(10.0 ** (35.0 * x)), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", ["exp", "expm1", "softplus", "tanh", "asinh", "asinh_of_exp"])
def test_huge_arguments_give_finite_values_and_nan_gives_nan(name):
    x = np.array([-1e300, -700.0, 700.0, 1e300, np.nan, -np.inf, np.inf, 0.0])
    (found,) = run(lambda one: [getattr(functions, name)(one)], 4, x)
    assert np.isnan(found[4])
    assert np.isfinite(found[:4]).all()


@pytest.mark.parametrize("x", [0.0, -1.0])
def test_logarithm_of_numbers_that_are_not_positive(x):
    (found,) = run(lambda one: [functions.log(one)], 2, np.array([x, 2.0]))
    assert np.isnan(found[0])
    assert found[1] == np.log(2.0)


def test_where_selects_in_compiled_code():
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


# Free address space: 1,000 holes that take constants but no code, then none for 8 GiB.  The
# simulation before loads the libraries and the solver's control.
SCATTERED_MEMORY = """
import ctypes
import ratestate as rs

libc = ctypes.CDLL(None)
libc.mmap.restype = ctypes.c_void_p
libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *4 * [ctypes.c_int]]
libc.munmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
PRIVATE, ANONYMOUS, NORESERVE = 0x2, 0x20, 0x4000
HOLE, CODE, SIZE = 12 << 10, 16 << 10, 8 << 30

def reserve(size):
    return libc.mmap(None, size, 0, PRIVATE | ANONYMOUS | NORESERVE, -1, 0)

def simulate(law):
    slider = rs.SpringSlider(a=0.005, b=0.01, Dc=1e-5, sigma=1e7, K=1e10, M=1e6, law=law)
    print(rs.simulate(slider, rs.Loading.constant(1e-3), 0.1, V_start=1e-4).V.values[-1])

simulate("aging")
start = reserve(SIZE)
size = SIZE
while size >= CODE:
    while (place := reserve(size)) > start:
        pass
    libc.munmap(place, size)
    size //= 2
for i in range(1, 1001):
    libc.munmap(start + SIZE - (i << 20), HOLE)
simulate("slip")
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the flags of mmap are Linux's")
def test_code_and_constants_lie_side_by_side_in_scattered_memory():
    done = subprocess.run([sys.executable, "-c", SCATTERED_MEMORY], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    first, second = map(float, done.stdout.split())
    assert first == pytest.approx(1.723113e-4, rel=1e-5)
    assert second == pytest.approx(4.905412e-4, rel=1e-5)


def test_missing_functions_are_reported_on_loading():
    code = compile_object("define void @f() { ret void }")
    with pytest.raises(ImportError, match="lacks g"):
        load_functions(code, ["f", "g"])


# ------------------------------------------------------------------------------ other processors


@pytest.mark.parametrize(
    ("triple", "cpu"),
    [("x86_64-unknown-linux-gnu", "x86-64"), ("aarch64-unknown-linux-gnu", "generic")],
)
@pytest.mark.parametrize("kind", [MarchUnits, ReturnUnits])
def test_objects_for_other_processors(triple, cpu, kind):
    """x86-64 without AVX, and aarch64: of a law's units, for vectors of two doubles."""
    names = [*lane_units(LAWS["slip"], kind), *point_units(LAWS["slip"], kind)]
    code = compile_object(unit_text(LAWS["slip"], kind, 2), target(cpu, "", triple))
    assert code[:4] == b"\x7fELF"
    assert code[18] == {"x86_64": 62, "aarch64": 183}[triple.partition("-")[0]]
    assert all(name.encode() in code for name in names)


def test_this_processor_without_avx(monkeypatch):
    """The same steps from vectors of two doubles, and of this processor's width."""
    law, name = LAWS["aging"], "step"
    s = np.random.default_rng(2).uniform(0.1, 0.9, rows_of(law).size)
    found = []
    for width, machine in ((2, target("x86-64", "")), (WIDTH, target())):
        code = compile_object(unit_text(law, MarchUnits, width), machine)
        buffer = s.copy()
        call = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int64)
        call(load_functions(code, [name])[name])(buffer.ctypes.data, LANES)
        found.append(buffer)
    assert (found[0] != s).any()
    np.testing.assert_allclose(*found, rtol=1e-8, atol=1e-12)


def test_the_width_is_that_in_which_this_processor_is_fastest(monkeypatch):
    def width(name, **features):
        monkeypatch.setattr(machine_code.llvm, "get_host_cpu_name", lambda: name)
        monkeypatch.setattr(machine_code.llvm, "get_host_cpu_features", lambda: features)
        return machine_code.doubles_of_vector()

    assert width("skylake-avx512", avx=True, avx512f=True) == 4
    assert width("znver4", avx=True, avx512f=True) == 8
    assert width("sapphirerapids", avx=True, avx512f=True) == 8
    assert width("znver2", avx=True, avx512f=False) == 4
    assert width("x86-64", sse2=True) == width("apple-m1", neon=True) == 2
