"""One slider a CUDA thread: in the simulator everywhere, and on the GPU where there is one.

The simulator runs the kernels as plain Python, with a Python thread for each of CUDA's.  That the
compiler takes them too is tried where numba-cuda and its toolkit are installed.
"""

import importlib.util
import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.dynamics.cycles import shooting
from ratestate.dynamics.cycles.system import System, state
from ratestate.engine import backend, cuda, dispatch
from ratestate.engine.model import FINISHED, RUNAWAY, STEADY_SLIDING, STEP_LIMIT
from ratestate.engine.return_map import DERIVATIVES, RETURN_NUMBERS
from ratestate.friction.laws import friction_law
from ratestate.sweeps.calls import call_of

OF_LAW = {"b2": 1e-3, "Dc2": 5e-5}
#: under laws of one state and of two, with and without exponentials in their rates
PAIRS = [
    ("simulations", "slip"),
    ("turns", "aging"),
    ("simulations", "two-state-slip"),
    ("turns", "two-state-aging"),
]
OTHERS = [("simulations", "aging"), ("turns", "slip")]
SOME, ALL = (
    pytest.mark.parametrize(("job", "law"), jobs) for jobs in (PAIRS[::3], PAIRS + OTHERS)
)  # (the simulator takes its time)
#: without recurrences
FORMS = [("simulations", "slip regularized"), ("simulations", "aging varying-stress")]
HAS_COMPILER = importlib.util.find_spec("numba_cuda") is not None
RTOL, CLOSE = 1e-10, 1e-9
N = 22  # sliders simulated
LOADING = rs.Loading.steps(1e-3, (2e-4, 1e-2), (6e-4, 0.0), (1e-3, 0.1))
SIMULATED = [
    "V",
    "theta",
    "tau",
    "delta",
    "V_max",
    "V_min",
    "inertial_force",
    "mu_min",
    "amplitude",
]
SIMULATED += ["frequency", "cycles", "energy_residual", "status", "steps"]
IN_A_PROCESS = """
import sys
import numpy as np
import test_cuda
from numba import config, cuda
from ratestate.engine import backend
from ratestate.engine import cuda as driver

if config.ENABLE_CUDASIM:  # fewer threads than cases: 6 in two blocks, or 18 in two rows of lanes
    type(cuda.current_context().device).MULTIPROCESSOR_COUNT = 1
    driver.BLOCK, driver.RESIDENT = (3, 2) if sys.argv[1] == "turns" else (18, 1)
    driver.LEAST_BUDGET = {"simulations": 300, "turns": 40, "interrupted": 15}[sys.argv[1]]
with backend.use(device="cuda"):
    found = getattr(test_cuda, sys.argv[1])(sys.argv[2])
np.savez(sys.argv[3], **found)
"""


# What is computed, here on the CPU and in another process on the GPU ------------------------------


def arguments(law):
    """Of brief runs through steps and a hold, of unlike lengths; each ninth slider has no mass.

    law : its name, and perhaps that of a form of friction, or that normal stress varies
    """
    law, *form = law.split()
    loading = LOADING.sigma_step(5e-4, "2.1 MPa") if form == ["varying-stress"] else LOADING
    rng = np.random.default_rng(3)
    a = 10 ** rng.uniform(-2.7, -2.0, N)
    M = np.where(np.arange(N) % 9 == 0, 0.0, 10 ** rng.uniform(1, 3, N))
    K = rng.uniform(0.3, 1.5, N) * np.where(M == 0.0, 0.4, 2.4) * a * 2e6 / 1e-5
    t_end = rng.uniform(7e-4, 1.3e-3, N)
    t_end[[9, 17]] = 3e-3
    values = {"a": a, "b": 1.8 * a, "K": K, "M": M, "t_end": t_end}
    arrays = {name: xr.DataArray(v, dims="case") for name, v in values.items()}
    t_end = arrays.pop("t_end")
    own = {symbol: OF_LAW[symbol] for symbol in friction_law(law).parameters}
    slider = rs.SpringSlider(**arrays, **own, Dc=1e-5, sigma=2e6, V0=1e-9, law=law)
    if form == ["regularized"]:
        slider = slider.replace(friction="regularized")
    return slider, loading, t_end


def simulations(law):
    """With saved times; and, as `end_V`, without any, by `Results` of this shape."""
    slider, loading, t_end = arguments(law)
    times = t_end * xr.DataArray([0.0, 0.3, 0.9, 1.0], dims="time")
    run = rs.simulate(slider, loading, t_end, times=times, rtol=RTOL)
    few = slider.replace(**{k: slider.parameters[k][:3] for k in ("a", "b", "K", "M")})
    results, march = [], dispatch.run_march
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            dispatch, "run_march", lambda *given: results.append(march(*given)) or results[0]
        )
        end = rs.simulate(few, loading, 5e-4, rtol=RTOL)
    out = {name: run[name].values for name in SIMULATED} | {"end_V": end.V.values}
    return out | {"shape": np.array(results[0].saved.shape)}


def turns(law):
    """With derivative and waveform, of many a slider; and three that do not come back.

    The third takes too many steps, the fifth is stable, the sixth has no mass and runs away.
    """
    kappa = np.array([0.3, 0.9, 0.76, 0.5, 1.5, 0.4, 0.6])
    eta = np.array([0.5, 2.0, 1e-3, 1e-8, 0.1, 0.0, 0.3])
    states = friction_law(law).states
    p = np.tile([1.8] if len(states) == 1 else [1.2, 0.6, 0.8], (7, 1))  # b/a, b2/a, Dc/Dc2
    system = System(law, kappa, p, eta, np.where(eta == 0.0, 0.1, np.inf))
    psi = np.array([-0.3, 0.3, 1.0, -3.0, -0.1, 0.5, 0.3])
    u = np.stack([psi, 0.5 * psi, np.linspace(0.1, 0.4, 7)], axis=1)[:, [*range(len(states)), 2]]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shooting, "MAX_STEPS_OF_RETURN", 700.0)
        found = shooting.return_map(
            system,
            state(system, u),
            RTOL,
            steady_tol=np.where(np.arange(7) == 4, 0.5, 0.0),
            observe=True,
            period=np.linspace(3.0, 9.0, 7),
        )
    back = found.came_back
    out = {"status": found.status, "image": found.image[back], "jacobian": found.jacobian[back]}
    out |= {name: found.numbers[name][back] for name in RETURN_NUMBERS}
    slopes = {name: found.gradients[name][back] for name in DERIVATIVES}
    return out | {
        f"{name} by {i}": d[:, i] for name, d in slopes.items() for i in range(u.shape[1])
    }


def interrupted(law):
    """The fractions that progress was told, until the third time it was."""
    stop, told = threading.Event(), []
    slider, loading, t_end = arguments(law)
    _, call = call_of("simulate", slider, {"loading": loading, "t_end": t_end, "rtol": RTOL})

    def progress(fraction):
        told.append(fraction)
        if len(told) == 3:
            stop.set()

    with backend.use(device="cuda", stop=stop), pytest.raises(backend.Stopped):
        call.move(progress)
    return {"told": told}


def on_gpu(job, law, folder, simulator=True):
    """What the job finds in a process of its own: the simulator is chosen as numba is imported."""
    environment = {"NUMBA_ENABLE_CUDASIM": "1", "NUMBA_DISABLE_JIT": "1"} if simulator else {}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", IN_A_PROCESS, job, law, str(folder / "found.npz")],
        env=os.environ | environment,
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    with np.load(folder / "found.npz") as found:
        return dict(found)


def same(found, expected):
    """All within `CLOSE` of each quantity's scale, and V, which varies by decades, of itself."""
    assert found.keys() == expected.keys()
    np.testing.assert_array_equal(found.pop("status"), expected["status"])
    # (by which method the next step is, and how far errors of rounding let it go, is rounding's)
    np.testing.assert_allclose(found.pop("steps"), expected["steps"], rtol=0.01, atol=8)
    for name, values in found.items():
        size = 1.0 if name == "energy_residual" else np.nanmax(np.abs(expected[name]), initial=0.0)
        atol = 0.0 if name in ("V", "theta", "end_V") else CLOSE * size
        np.testing.assert_allclose(values, expected[name], rtol=CLOSE, atol=atol, err_msg=name)


# In the simulator ---------------------------------------------------------------------------------


@SOME
def test_simulator(job, law, tmp_path):
    expected = globals()[job](law)
    fates = set(expected["status"].tolist())
    if job == "turns":
        assert {FINISHED, STEADY_SLIDING, RUNAWAY, STEP_LIMIT} == fates
        assert (expected["slow"] > 0).any()
    else:
        assert {FINISHED, RUNAWAY} == fates
        assert (expected["cycles"] > 0).any()
    same(on_gpu(job, law, tmp_path), expected)


def test_progress_and_interruption(tmp_path):
    told = on_gpu("interrupted", "slip", tmp_path)["told"]
    assert told.size == 3  # no more after the event was set
    assert 0.0 < told[0] < 0.5
    assert (np.diff(told) > 0.0).all()
    assert told[-1] < 1.0


# On a GPU, and its compiler -----------------------------------------------------------------------


@pytest.mark.skipif(not HAS_COMPILER or bool(cuda._missing()), reason="needs a GPU")
@ALL
def test_gpu(job, law, tmp_path):
    same(on_gpu(job, law, tmp_path, simulator=False), globals()[job](law))


class Launched(Exception):
    """Instead of a launch; its arguments are those of `cuda._work`."""


@pytest.mark.skipif(not HAS_COMPILER, reason="needs numba-cuda")
@pytest.mark.parametrize(("job", "law"), PAIRS + OTHERS + FORMS)
def test_compiler(job, law, monkeypatch):
    """The kernels compile without a GPU: in double precision, the steps without a call."""
    from numba import cuda as numba_cuda
    from numba import typeof, types
    from numba.cuda import dispatcher
    from numba.cuda.cudadrv import nvvm

    if not nvvm.is_available():
        pytest.skip("needs the CUDA toolkit")

    def launch(*given):
        raise Launched(*given)

    def contiguous(arrays):
        return type(arrays)(*map(np.ascontiguousarray, arrays))

    class Hopper:
        compute_capability = (9, 0)

    monkeypatch.setattr(dispatcher, "get_current_device", Hopper)
    monkeypatch.setattr(cuda, "check", lambda: None)
    monkeypatch.setattr(cuda, "_work", launch)
    with backend.use(device="cuda"), pytest.raises(Launched) as caught:
        globals()[job](law)
    kernel, size, order, given, found, *_ = caught.value.args
    *named, times = given if job == "simulations" else (*given, None)
    rest = [*map(contiguous, named), *([] if times is None else [times]), contiguous(found)]
    counts = np.zeros(2, np.int64), np.zeros(1)
    values = np.zeros((1, size)), order, *counts, *rest, 1
    signature = types.void(*map(typeof, values))
    code, _ = numba_cuda.compile_ptx(kernel.py_func, signature, cc=Hopper.compute_capability)
    assert code.count("fma.rn.f64") > 300
    assert not re.search(r"(add|sub|mul|div|fma)[.a-z]*\.f32", code)
    assert not re.search(r"\bcall\b[^;]*step", code)


# Where there is none ------------------------------------------------------------------------------


def test_without_numba_cuda(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(rs.ParameterError, match=r"not found here: numba-cuda; leave device out"):
        cuda.check()


@pytest.mark.parametrize(
    ("error", "words"),
    [
        ("\nCUDA driver library cannot be found.\nEnsure ...\n:\n", "here: CUDA driver library"),
        (None, "here: the CUDA toolkit"),
    ],
)
def test_without_a_gpu(monkeypatch, error, words):
    import numba.cuda

    monkeypatch.setattr(importlib.util, "find_spec", lambda name: name)
    monkeypatch.setattr(numba.cuda, "is_available", lambda: False)
    monkeypatch.setattr(numba.cuda, "cuda_error", lambda: error)
    with pytest.raises(rs.ParameterError, match=words) as caught:
        cuda.check()
    assert "pip install 'ratestate[gpu]'" in str(caught.value)
    with backend.use(device="cuda"), pytest.raises(rs.ParameterError, match="NVIDIA GPU"):
        turns("slip")


@pytest.mark.parametrize(("cases", "launches"), [(0, []), (1, [1]), (2, [2])])
def test_no_case_is_no_launch(cases, launches, monkeypatch):
    seen = []
    monkeypatch.setattr(
        cuda, "_unguarded_launches", lambda _, size, order, *__: seen.append(len(order)) or []
    )
    cuda._work(None, 1, np.arange(cases), (), (), None)
    assert seen == launches


def test_a_failure_of_the_compiler_is_said_at_once(monkeypatch):
    """And not taken for one of a case, after which a sweep would try each half of the cases."""

    def fail(*given):
        raise AttributeError("module 'numpy' has no attribute 'row_stack'")
        yield

    monkeypatch.setattr(cuda, "check", lambda: None)
    monkeypatch.setattr(cuda, "_unguarded_launches", fail)
    message = (
        r"^the GPU failed \(AttributeError: module 'numpy' has no attribute 'row_stack'\); if its"
    )
    slider = rs.SpringSlider(a=0.01, b=0.02, Dc=1e-5, sigma=2e6, K=1e9, M=1e3)
    with pytest.raises(rs.SolverError, match=message):
        rs.sweep("limit_cycle", slider, V_lp=rs.logspace("V_lp", 1e-6, 1e-5, 4), device="cuda")


def test_an_error_of_progress_is_its_own(monkeypatch):
    monkeypatch.setattr(cuda, "_unguarded_launches", lambda *_: iter([0.5]))

    def fail(fraction):
        raise ZeroDivisionError(fraction)

    with pytest.raises(ZeroDivisionError, match=r"^0\.5$"):
        cuda._work(None, 1, np.arange(1), (), (), fail)


def test_nothing_is_imported_unasked():
    script = "import sys, ratestate.engine.cuda; sys.exit('numba.cuda' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
