"""One slider a CUDA thread: emulated everywhere, and on the GPU if there is one.

The emulated driver (`Emulator`) compiles the LLVM text of a kernel, of which the PTX is made, for
this machine, and runs its threads one after the other.  NVIDIA's assembler checks the PTX if it is
installed (`make cuda`).
"""

import contextlib
import ctypes
import os
import re
import subprocess
import threading
from functools import partial

import numpy as np
import pytest
import xarray as xr

import ratestate as rs
from ratestate.dynamics.cycles import shooting
from ratestate.dynamics.cycles.system import System, state
from ratestate.engine import backend, cuda, cuda_driver, dispatch, machine_code
from ratestate.engine.model import FINISHED, RUNAWAY, STEADY_SLIDING, STEP_LIMIT
from ratestate.engine.return_map import DERIVATIVES, RETURN_NUMBERS, Starts
from ratestate.friction.laws import friction_law
from ratestate.sweeps.calls import call_of
from ratestate.sweeps.identity import origin

OF_LAW = {"b2": 1e-3, "Dc2": 5e-5}
#: under laws of one state and of two, with and without exponentials in their rates, without
#: recurrences, and under normal stress that jumps
SOME = [
    ("simulations", "slip"),
    ("returns", "two-state-aging"),
    ("simulations", "slip regularized"),
    ("simulations", "aging varying-stress"),
]
MORE = [
    ("returns", "aging"),
    ("simulations", "two-state-slip"),
    ("simulations", "aging"),
    ("returns", "slip"),
]
RTOL, CLOSE = 1e-10, 1e-9
N = 22  # sliders simulated
LOADING = rs.Loading.steps(1e-3, (2e-4, 1e-2), (6e-4, 0.0), (1e-3, 0.1))
SIMULATED = ["V", "theta", "tau", "delta", "V_max", "V_min", "inertial_force", "mu_min"]
SIMULATED += ["amplitude", "frequency", "cycles", "energy_residual", "status", "steps"]

THREAD_OF_HOST = """
@number = internal global i32 0

define internal i32 @thread() {
  %n = load i32, ptr @number
  ret i32 %n
}

define void @start(ptr addrspace(1) %words, i64 %budget, i32 %thread) {
  store i32 %thread, ptr @number
  call void @kernel(ptr addrspace(1) %words, i64 %budget)
  ret void
}
"""


class Emulator:
    """A replacement of NVIDIA's driver: memory is the host's, threads run in turn.

    It has one multiprocessor, and fails in the function `broken`.
    """

    def __init__(self, broken=""):
        self.broken, self.memory, self.kernels, self.launches = broken, {}, [], []

    def __getattribute__(self, name):
        if name.startswith("cu") and name == self.broken:
            return lambda *_: 2
        return super().__getattribute__(name)

    def cuInit(self, flags):
        return 0

    def cuDeviceGet(self, device, number):
        device._obj.value = 7
        return 0

    def cuDeviceGetAttribute(self, value, attribute, device):
        assert device.value == 7
        value._obj.value = {16: 1, 75: 9, 76: 0}[attribute]
        return 0

    def cuDeviceGetName(self, name, size, device):
        name.value = b"Emulator"
        return 0

    def cuDevicePrimaryCtxRetain(self, context, device):
        context._obj.value = 1 << 40
        return 0

    def cuCtxSetCurrent(self, context):
        assert context.value == 1 << 40
        return 0

    def cuGetErrorString(self, code, text):
        text._obj.value = {2: b"out of memory"}[code]
        return 0

    def cuMemAlloc_v2(self, place, size):
        assert size.value > 0
        memory = np.full(size.value, 0xFF, np.uint8)
        place._obj.value = memory.ctypes.data
        self.memory[memory.ctypes.data] = memory
        return 0

    def cuMemFree_v2(self, place):
        del self.memory[place.value]
        return 0

    def cuMemcpyHtoD_v2(self, there, here, size):
        assert size.value <= self.memory[there.value].size
        ctypes.memmove(there.value, here, size.value)
        return 0

    def cuMemcpyDtoH_v2(self, here, there, size):
        assert size.value <= self.memory[there.value].size
        ctypes.memmove(here, there.value, size.value)
        return 0

    def cuModuleLoadData(self, module, image):
        text = image.decode().replace("ptx_kernel ", "")
        text, count = re.subn(
            r"define internal i32 @thread.*?\n}", THREAD_OF_HOST, text, flags=re.S
        )
        assert count == 1
        code = machine_code.compile_object(text, level=1)
        start = machine_code.load_functions(code, ["start"])["start"]
        kind = ctypes.CFUNCTYPE(None, ctypes.c_uint64, ctypes.c_int64, ctypes.c_int32)
        self.kernels.append(kind(start))
        module._obj.value = len(self.kernels)
        return 0

    def cuModuleGetFunction(self, function, module, name):
        assert name == b"kernel"
        function._obj.value = module.value
        return 0

    def cuLaunchKernel(self, kernel, *given):
        *shape, shared, stream, places, extra = given
        assert (shape[1:3], shape[4:], shared, stream, extra) == ([1, 1], [1, 1], 0, None, None)
        words = ctypes.c_uint64.from_address(places[0]).value
        budget = ctypes.c_int64.from_address(places[1]).value
        self.launches.append((shape[0], shape[3], budget))
        for thread in range(shape[0] * shape[3]):
            self.kernels[kernel.value - 1](words, budget, thread)
        return 0


@contextlib.contextmanager
def emulated(job="simulations", broken=""):
    """Replace the driver by an `Emulator`, which receives the LLVM text of kernels.

    It has fewer threads than a job has cases: 6 in two blocks, or 18 in two sets of lanes.
    """
    driver = Emulator(broken)
    cached = cuda_driver.device, cuda_driver._context, cuda_driver.function
    with pytest.MonkeyPatch.context() as change:
        change.setattr(cuda_driver, "library", lambda: driver)
        change.setattr(cuda, "ptx", str.encode)
        change.setattr(machine_code, "cached_code", lambda name, make: make())
        change.setattr(cuda, "BLOCK", 3 if job == "returns" else 18)
        change.setattr(cuda, "WARPS", 2 if job == "returns" else 1)
        change.setattr(cuda, "MAX_GROWTH", 1)
        budgets = {"simulations": 300, "returns": 40, "interrupted": 15}
        change.setattr(cuda, "MIN_BUDGET", budgets[job])
        for function in cached:
            function.cache_clear()
        yield driver
        for function in cached:
            function.cache_clear()
    assert not driver.memory


# What is computed, here on the CPU and in another process on the GPU ------------------------------


def arguments(law):
    """Return brief runs of various lengths through steps and a hold.

    law : name of the law, and perhaps of a form of friction, or "varying-stress"
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
        slider = slider.replace(friction_form="regularized")
    return slider, loading, t_end


def simulations(law):
    """With saved times; and, as `end_V`, without any, so that some arrays are empty."""
    slider, loading, t_end = arguments(law)
    times = t_end * xr.DataArray([0.0, 0.3, 0.9, 1.0], dims="time")
    run = rs.simulate(slider, loading, t_end, times=times, rtol=RTOL)
    few = slider.replace(**{k: slider.parameters[k][:3] for k in ("a", "b", "K", "M")})
    end = rs.simulate(few, loading, 5e-4, rtol=RTOL)
    return {name: run[name].values for name in SIMULATED} | {"end_V": end.V.values}


def returns(law):
    """With derivative and waveform, of many a slider; and three that do not come back.

    The third takes too many steps, the fifth is stable, the sixth has no mass and runs away.
    """
    kappa = np.array([0.3, 0.9, 0.76, 0.5, 1.5, 0.4, 0.6])
    eta = np.array([0.5, 2.0, 1e-3, 1e-8, 0.1, 0.0, 0.3])
    formula = friction_law(law)
    states, b = formula.states, 1.8 if len(formula.states) == 1 else 1.2
    values = {"a": 1.0, "b": b, "b2": 0.6, "Dc": 1.0, "Dc2": 1.25, "sigma": 1.0}
    p = np.tile(np.array(formula.coefficient_arrays(1.0, values)), (7, 1))
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
    back = found.has_returned
    out = {"status": found.status, "image": found.image[back], "jacobian": found.jacobian[back]}
    out |= {name: found.numbers[name][back] for name in RETURN_NUMBERS}
    slopes = {name: found.gradients[name][back] for name in DERIVATIVES}
    return out | {
        f"{name} by {i}": d[:, i] for name, d in slopes.items() for i in range(u.shape[1])
    }


def same(found, expected):
    """Compare results to `CLOSE` of a quantity's scale, or of itself for V and theta."""
    assert found.keys() == expected.keys()
    np.testing.assert_array_equal(found.pop("status"), expected["status"])
    # (by which method the next step is, and how far errors of rounding let it go, is rounding's)
    np.testing.assert_allclose(found.pop("steps"), expected["steps"], rtol=0.01, atol=8)
    for name, values in found.items():
        size = 1.0 if name == "energy_residual" else np.nanmax(np.abs(expected[name]), initial=0.0)
        atol = 0.0 if name in ("V", "theta", "end_V") else CLOSE * size
        np.testing.assert_allclose(values, expected[name], rtol=CLOSE, atol=atol, err_msg=name)


# In the emulator ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("job", "law"), SOME[1:])
def test_the_kernels_emulated_on_the_cpu_equal_the_cpu_results(job, law):
    expected = globals()[job](law)
    fates = set(expected["status"].tolist())
    if job == "returns":
        assert {FINISHED, STEADY_SLIDING, RUNAWAY, STEP_LIMIT} == fates
        assert (expected["slow"] > 0).any()
    else:
        assert fates == ({FINISHED} if "varying" in law else {FINISHED, RUNAWAY})
        assert (expected["cycles"] > 0).any()
    with emulated(job) as driver, backend.use(device="cuda"):
        found = globals()[job](law)
    assert len(driver.launches) > 3  # what is under way is left and taken up again
    same(found, expected)


def test_progress_and_interruption():
    """No progress is reported after the event was set; an error of it is its own."""
    slider, loading, t_end = arguments("slip")
    call = call_of("simulate", slider, {"loading": loading, "t_end": t_end, "rtol": RTOL})[1]
    stop, fractions = threading.Event(), []

    def progress(fraction):
        fractions.append(fraction)
        if len(fractions) == 3:
            stop.set()

    with emulated("interrupted"), backend.use(device="cuda", stop=stop):
        with pytest.raises(ZeroDivisionError):
            call.move(partial(raise_error, ZeroDivisionError()))
        with pytest.raises(backend.Stopped):
            call.move(progress)
    assert len(fractions) == 3
    assert 0.0 < fractions[0] < 0.5
    assert (np.diff(fractions) > 0.0).all()
    assert fractions[-1] < 1.0


def test_the_processor_of_a_store_names_the_gpu():
    with emulated():
        found = origin("cuda")["processor"]
    assert found == origin("cpu")["processor"] | {"gpu": "Emulator, compute capability 9.0"}


# PTX ----------------------------------------------------------------------------------------------


def ptx(job, law):
    """Return the PTX text of the kernel for a job."""
    with emulated(job), backend.use(device="cuda"), pytest.MonkeyPatch.context() as change:
        images = []
        change.setattr(cuda_driver, "function", images.append)
        change.setattr(cuda_driver, "launch", partial(raise_error, KeyboardInterrupt()))
        with pytest.raises(KeyboardInterrupt):
            globals()[job](law)
    return cuda.ptx(images[0].decode()).decode()


@pytest.mark.parametrize(("job", "law"), SOME[:2])
def test_ptx(job, law):
    """Contracted doubles alone; nothing is missing, or called at an address."""
    code = ptx(job, law)
    functions = re.split(r"^(?=\.func|\.visible)", code, flags=re.MULTILINE)[1:]
    names = {re.search(r"(\S+)\($", one.splitlines()[0])[1] for one in functions}
    called = set(
        re.findall(r"^\s*call(?:\.uni)?[^;]*?\b([A-Za-z_][\w$]*),?\s*\(", code, re.MULTILINE)
    )
    assert "kernel" in names
    assert called <= names
    assert ".callprototype" not in code
    assert ".extern" not in code
    assert code.count("fma.rn.f64") > 300
    assert not re.search(r"\.f32|\.f16", code)
    # The steps stand in the loop, and reach the lanes as global memory.
    assert not {"step", "taylor", "commit"} & names
    (loop,) = (one for one in functions if re.match(r"\S+ march_lane", one))
    assert loop.count("st.global.b64") > 100
    assert loop.count("ld.global.b64") > 2 * loop.count("ld.b64")


@pytest.mark.skipif("PTXAS" not in os.environ, reason="make cuda runs it")
@pytest.mark.parametrize(("job", "law"), SOME + MORE)
def test_assembler(job, law, tmp_path):
    """Each kind of GPU has code of it, which keeps nearly all of a step in registers."""
    (tmp_path / "kernel.ptx").write_text(ptx(job, law))
    for kind in ("sm_70", "sm_90"):
        command = [os.environ["PTXAS"], "-v", f"-arch={kind}", "kernel.ptx", "-o", "kernel.cubin"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        spilled = sum(map(int, re.findall(r"(\d+) bytes spill stores", done.stderr)))
        assert spilled < (10_000 if job == "returns" else 200)
        assert 128 < int(re.search(r"Used (\d+) registers", done.stderr)[1]) <= 255


# On a GPU -----------------------------------------------------------------------------------------


def has_gpu():
    try:
        cuda.check()
    except rs.ParameterError:
        return False
    return True


@pytest.mark.skipif(not has_gpu(), reason="needs a GPU")
@pytest.mark.parametrize(("job", "law"), SOME + MORE)
def test_the_kernels_on_a_gpu_give_the_same_bits_each_time(job, law):
    with backend.use(device="cuda"):
        found = globals()[job](law)
    same(found, globals()[job](law))


# Where there is none, or it fails -----------------------------------------------------------------


@pytest.mark.parametrize("library", ["libcuda.so.1: not there", ""])
def test_without_a_gpu(library):
    with emulated(broken="cuInit"), pytest.MonkeyPatch.context() as change:
        if library:
            change.setattr(cuda_driver, "library", partial(raise_error, OSError(library)))
        with backend.use(device="cuda"), pytest.raises(rs.ParameterError) as caught:
            returns("slip")
    assert str(caught.value) == (
        f"device = 'cuda' needs an NVIDIA GPU with its driver, which was not found"
        f" ({library or 'cuInit: out of memory'}). Leave device out to run on the CPU."
    )


def raise_error(error, *_):
    raise error


def test_without_cases_no_gpu_is_needed():
    with backend.use(device="cuda"):
        found = dispatch.run_returns(None, Starts(*[np.empty((0, 3))] * len(Starts._fields)))
    assert found.numbers.shape == (0, len(RETURN_NUMBERS))


@pytest.mark.parametrize("broken", ["cuModuleLoadData", "cuMemAlloc_v2", "cuLaunchKernel"])
def test_a_failure_of_the_gpu_is_reported_at_once(broken):
    """And not taken for one of a case, after which a sweep would try each half of the cases."""
    slider = rs.SpringSlider(a=0.01, b=0.02, Dc=1e-5, sigma=2e6, K=1e9, M=1e3)
    message = rf"^The GPU failed \(CudaError: {broken}: out of memory\)\. If it lacks memory"
    with emulated(broken=broken), pytest.raises(rs.SolverError, match=message):
        rs.sweep("limit_cycle", slider, V_lp=rs.logspace("V_lp", 1e-6, 1e-5, 4), device="cuda")
