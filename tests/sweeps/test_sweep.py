"""`sweep`: the same bits as the function, however it is cut; bad cases; interruption; progress."""

import contextlib
import dataclasses
import itertools
import math
import os
import sys
import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from hypothesis import given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate.dynamics.cycles.limit_cycle import LimitCycleCall
from ratestate.dynamics.progress import duration
from ratestate.dynamics.simulation.simulate import SimulateCall
from ratestate.dynamics.steady_sliding import StabilityCall
from ratestate.engine import backend, dispatch
from ratestate.engine.model import CRASHED, RUNAWAY, STATUSES
from ratestate.errors import RunWarning
from ratestate.sweeps import chunks as chunks_module
from ratestate.sweeps import progress, tasks
from ratestate.sweeps.calls import call_of
from ratestate.sweeps.chunks import Chunks, chunks_of, sample_of
from ratestate.sweeps.solve import VariableSpec, form_of, halves, solve
from ratestate.sweeps.status import failures
from ratestate.sweeps.tasks import Outcome

FIG2 = {"a": 0.003, "b": 0.006, "Dc": 1e-5, "sigma": 2e6, "K": 9e8}
SLIDER = rs.SpringSlider(**FIG2, M=rs.logspace("M", 100, 1e5, 3))
V_LP = rs.logspace("V_lp", 2e-3, 1e-1, 4)
CALLS = {
    "limit_cycle": {"V_lp": V_LP, "rtol": 1e-6},
    "stability": {"V_lp": V_LP},
    "simulate": {
        "loading": rs.Loading.steps("0.1 mm/s", (0.01, V_LP)),
        "t_end": 0.05,
        "times": [0.0, 0.01, 0.05],
    },
}


def sweep(function, slider=SLIDER, **how):
    return rs.sweep(function, slider, **({"progress": False} | how))


# ---------------------------------------------------------------------------------- how it is cut

sizes = st.lists(st.integers(1, 7), min_size=1, max_size=4).map(
    lambda found: {f"d{i}": n for i, n in enumerate(found)}
)


@given(sizes, st.integers(1, 300))
def test_chunks_tile_the_sweep_in_order(sizes, most):
    chunks = chunks_of(sizes, most)
    numbers = np.arange(math.prod(sizes.values())).reshape(*sizes.values())
    found = [
        numbers[tuple(slices.values())].ravel()
        for slices in map(chunks.slices, range(chunks.number))
    ]
    assert np.array_equal(np.concatenate(found), np.arange(numbers.size))
    assert [part.size for part in found] == [chunks.cases(i) for i in range(chunks.number)]
    assert max(part.size for part in found) <= most
    # No larger blocks of the kind would do with as many chunks along each dimension.
    whole = list(itertools.takewhile(lambda k: chunks.counts[-1 - k] == 1, range(len(sizes))))
    assert math.prod([1, *list(sizes.values())[len(sizes) - len(whole) :]]) <= most

    # They are of about equal size.
    for n, k, count in zip(sizes.values(), chunks.shape, chunks.counts, strict=True):
        assert 1 <= k <= n
        assert (count - 1) * k < n <= count * k
        assert k == -(-n // count)


@given(sizes)
def test_halves_of_a_block_cover_it(sizes):
    if math.prod(sizes.values()) == 1:
        return
    dim, (first, second) = halves(sizes)
    assert first[dim].start == 0
    assert first[dim].stop == second[dim].start > 0
    assert second[dim].stop == sizes[dim] == max(sizes.values())


@given(sizes)
def test_a_sample_lies_all_over_the_sweep(sizes):
    arrays = {dim: xarray.DataArray(np.ones(n), dims=dim) for dim, n in sizes.items()}
    mass = 1e3 * math.prod(arrays.values())
    call = call_of("stability", SLIDER.replace(M=mass), {"V_lp": 1e-3})[1]
    found = sample_of(call, 256).batch.sizes
    assert found.keys() == sizes.keys()
    assert 1 <= math.prod(found.values()) <= 256
    assert all(n > 1 or sizes[dim] == 1 for dim, n in found.items())


def here_and_now(function, *arguments):
    return function(*arguments)


KINDS = {"period": VariableSpec(("case",), np.dtype(float), {}, {})}


@pytest.mark.parametrize(
    ("seconds", "n", "workers", "cases"),
    [
        (1e-3, 1000, 2, 500),  # 1 s: one chunk each
        (1e-3, 10**4, 2, 1000),  # 10 s: of 1 s
        (1e-3, 10**6, 2, 10000),  # 1000 s: of 10 s
        (1e-9, 10**12, 2, (1 << 27) // 8),  # never more than fits into memory
        (1e-2, 10**5, 50, 128),  # 1000 s on 50 workers: 16 for each, were there not the lanes
        (0.1, 500, 2, 500),  # not enough to cut it and fill all lanes
        (0.1, 600, 2, 128),
        (20.0, 200, 2, 30),  # more than an hour: no longer than 10 minutes each ...
        (100.0, 1000, 2, 16),  # ... but a case for each lane
    ],
)
def test_chunks_take_seconds(monkeypatch, seconds, n, workers, cases):
    monkeypatch.setattr(chunks_module, "seconds_per_case", lambda *_: seconds)
    monkeypatch.setattr(chunks_module, "sample_of", lambda *_: None)
    call, form = SimpleNamespace(batch=SimpleNamespace(n=n, sizes={})), SimpleNamespace(specs=KINDS)
    backend = SimpleNamespace(shared=True, thread_count=workers, run=here_and_now)
    request = SimpleNamespace(call=call, form=form, device="cpu", backend=backend)
    assert chunks_module.cases_per_chunk(request) == cases


def test_a_probe_stops_in_time():
    slider = SLIDER.replace(K=rs.logspace("K", 7e8, 8e8, 10))
    how = {"loading": rs.Loading.constant("0.1 m/s"), "V_start": "10 mm/s", "t_end": 20.0}
    call = call_of("simulate", slider, how)[1]
    solve(dataclasses.replace(call, t_end=1e-3), {})  # compile
    begin = time.perf_counter()
    a_case = chunks_module.seconds_per_case(call, form_of(call).specs)
    spent = time.perf_counter() - begin
    assert a_case > 1e-3
    assert spent < 30 * a_case  # there are 30 cases


# ------------------------------------------------------------------------------------- same bits


@pytest.mark.parametrize("function", CALLS)
@pytest.mark.parametrize("chunk", [None, 1, 7])
def test_a_function_and_its_sweep_agree(function, chunk):
    alone = getattr(rs, function)(SLIDER, **CALLS[function])
    found = sweep(function, chunk=chunk, **CALLS[function])
    added = ["message"] if "status" in alone else ["message", "status"]
    assert set(found.data_vars) == {*alone.data_vars, *added}
    xarray.testing.assert_identical(found.drop_vars(added), alone)
    assert (found.message == "").all()
    assert found.message.dtype == object
    assert (found.status <= 1).all()


@settings(deadline=None, max_examples=5)
@given(st.data())
def test_a_case_has_the_same_bits_in_any_sweep(data):
    n = data.draw(st.integers(1, 40))
    log = st.floats(-1.0, 1.0)
    mass = [1e3 * 10 ** data.draw(log) for _ in range(n)]
    speed = [1e-2 * 10 ** data.draw(log) for _ in range(n)]
    slider = rs.SpringSlider(**FIG2, M=xarray.DataArray(mass, dims="case"))
    V_lp = xarray.DataArray(speed, dims="case")
    whole = sweep("limit_cycle", slider, V_lp=V_lp, rtol=1e-6)
    pieces = sweep("limit_cycle", slider, V_lp=V_lp, rtol=1e-6, chunk=data.draw(st.integers(1, n)))
    xarray.testing.assert_identical(whole, pieces)


# ------------------------------------------------------------------------------------- bad cases


def test_a_failed_case_costs_itself_only():
    slider = rs.SpringSlider(**FIG2 | {"K": xarray.DataArray([5e8, 7e8], dims="K")})  # M = 0
    V = xarray.DataArray([1e-6, 1.05e-6], dims="step")
    loading = rs.Loading.steps("1 um/s", (1.0, V))
    with pytest.warns(RunWarning, match="in 1 of 4 cases"):  # unstable, and no step
        found = sweep("simulate", slider, loading=loading, t_end=2000.0, chunk=1)
    assert found.status.sel(K=5e8).values.tolist() == [0, RUNAWAY]
    assert found.status.sel(K=7e8).values.tolist() == [0, 0]
    bad = found.where(found.status > 1, drop=True)
    assert bad.message.values.tolist() == [[STATUSES[RUNAWAY][1]]]
    assert np.isnan(bad.tau).all()
    listed, number = failures(found)
    assert listed == [({"K": 5e8, "step": 1}, "quasi_static_instability", STATUSES[RUNAWAY][1])]
    assert number == 1
    assert failures(found, most=0) == ([], 1)


BAD = 1e4


@pytest.fixture
def raising(monkeypatch):
    """Let `limit_cycle` raise where a slider has the mass `BAD`."""
    run = LimitCycleCall.run

    def raises(self, progress=None):
        if (self.batch.flat("M") == BAD).any():
            raise ZeroDivisionError("spanner")
        return run(self, progress)

    monkeypatch.setattr(LimitCycleCall, "run", raises)


@pytest.mark.parametrize(("chunk", "store"), [(None, False), (5, True)])
def test_a_case_that_raises_has_the_status_crashed(raising, chunk, store, tmp_path):
    mass = xarray.DataArray([1e3, 2e3, 3e3, BAD], dims="M")
    slider, speeds = rs.SpringSlider(**FIG2, M=mass), V_LP[1:3]
    good = [0, 1, 2]
    path = tmp_path / "x.zarr" if store else None
    found = sweep("limit_cycle", slider, V_lp=speeds, chunk=chunk, store=path, rtol=1e-6)
    assert (found.status.isel(M=3) == CRASHED).all()
    assert (found.outside_domain.isel(M=3) == -1).all()
    assert all("ZeroDivisionError: spanner" in text for text in found.message.isel(M=3).values)
    assert np.isnan(found.period.isel(M=3)).all()
    assert not found.stable.isel(M=3).any()
    rest = rs.limit_cycle(slider.replace(M=mass[good]), speeds, rtol=1e-6)
    for name, variable in rest.data_vars.items():
        assert np.array_equal(found[name].isel(M=good), variable, equal_nan=True), name


def test_an_error_of_compiling_ends_a_sweep_and_is_not_stored(monkeypatch, tmp_path):
    def uncompiled(self, progress=None):
        raise rs.CompilationError("spanner")

    with monkeypatch.context() as patch:
        patch.setattr(StabilityCall, "run", uncompiled)
        with pytest.raises(rs.CompilationError, match="spanner"):
            sweep("stability", V_lp=V_LP, store=tmp_path / "x.zarr")
    assert (sweep("stability", V_lp=V_LP, store=tmp_path / "x.zarr").status == 0).all()


@pytest.mark.parametrize("other", [BAD, 1e3])
def test_the_first_case_may_raise(raising, other):
    slider = rs.SpringSlider(**FIG2, M=xarray.DataArray([BAD, other], dims="M"))
    found = sweep("limit_cycle", slider, V_lp=V_LP[:2])
    assert (found.status.isel(M=0) == CRASHED).all()
    assert ((found.status.isel(M=1) == CRASHED) == (other == BAD)).all()


def test_variables_that_all_cases_share_are_kept(monkeypatch):
    def raises(self, progress=None):
        raise ZeroDivisionError

    alone = sweep("simulate", chunk=2, **CALLS["simulate"])
    run = SimulateCall.run
    monkeypatch.setattr(
        SimulateCall,
        "run",
        lambda self, progress=None: (raises if 1e5 in self.batch.flat("M") else run)(self),
    )
    found = sweep("simulate", chunk=2, **CALLS["simulate"])
    assert np.array_equal(found.time, alone.time)
    assert (found.status.sel(M=1e5) == CRASHED).all()
    assert found.isel(M=slice(0, 2)).identical(alone.isel(M=slice(0, 2)))


@pytest.mark.parametrize("chunk", [None, 1])
def test_variables_that_some_cases_share_are_kept(monkeypatch, chunk):
    run = StabilityCall.run

    def raises(self, progress=None):
        if 100.0 in self.batch.flat("M") and progress is not self:
            raise ZeroDivisionError
        return run(self)

    monkeypatch.setattr(StabilityCall, "blank", run)
    monkeypatch.setattr(StabilityCall, "run", raises)
    slider = SLIDER.replace(b=xarray.DataArray([0.006, 0.007], dims="b"))
    found = sweep("stability", slider, V_lp=1e-3, chunk=chunk)
    assert found.K_c_qs.dims == ("b",)
    if chunk is None:  # (the first chunk along M alone brings it)
        assert found.K_c_qs.values.tolist() == pytest.approx([6e8, 8e8])


# -------------------------------------------------------------------------------------- bad input


@pytest.mark.parametrize(
    ("how", "message"),
    [
        (
            {"function": "hopf"},
            "function = 'hopf' cannot be swept. Choose one of limit_cycle, simulate",
        ),
        ({"function": rs.hopf}, "cannot be swept"),
        ({"V_lp": None}, "V_lp"),
        ({"V_lpp": 1.0}, "has no parameter V_lpp"),
        ({"V_lp": xarray.DataArray([1.0, -1.0], dims="V_lp")}, r"V_lp = -1 m/s .* must be > 0"),
        (
            {"slider": SLIDER.replace(M=xarray.DataArray([1e3], dims="message"))},
            "'message' clashes",
        ),
        ({"slider": SLIDER.replace(M=xarray.DataArray([1e3], dims="a/b"))}, "'a/b' clashes"),
        (
            {"slider": SLIDER.replace(M=xarray.DataArray([1e3], {"x": [object()]}, ("x",)))},
            "'x' has labels that cannot be stored",
        ),
        ({"client": "tcp://1"}, r"client = 'tcp://1' is not a dask.distributed.Client"),
        (
            {"client": SimpleNamespace(nthreads=None), "slurm": "cores=1,memory=1GB"},
            "client and slurm are both given",
        ),
        ({"store": 3}, "store = 3 must be the path of a folder"),
        ({"store": "s3://bucket/x.zarr"}, "must be the path of a folder"),
        ({"slider": 3}, "slider = 3 is not a SpringSlider"),
        ({"slider": SLIDER.replace(M=1e3), "V_lp": 1e-3}, "nothing to sweep over"),
        ({"chunk": 0}, "chunk = 0 must be a number of cases"),
        ({"chunk": 1.5}, "chunk = 1.5 must"),
        ({"chunk": True}, "chunk = True must"),
        ({"device": "tpu"}, "device = 'tpu' is unknown. Choose one of cpu, cuda"),
        ({"function": "stability", "device": "cuda"}, "needs no GPU. Leave device out"),
    ],
)
def test_bad_input(how, message):
    how = {"function": "limit_cycle", "slider": SLIDER, "V_lp": V_LP} | how
    with pytest.raises(rs.ParameterError, match=message):
        sweep(how.pop("function"), how.pop("slider"), **how)


def test_contradictions_are_refused_before_anything_runs(tmp_path):
    slider = rs.SpringSlider(**FIG2, M=xarray.DataArray([1e3, 1e3, 0.0], dims="M"))
    initial = {"V": 1e-3, "theta": 1e-2, "tau": 1e6}
    arguments = {"loading": rs.Loading.constant(1e-3), "t_end": 1.0, "initial": initial}
    with pytest.raises(rs.ParameterError, match="do not agree: without inertia"):
        sweep("simulate", slider, store=tmp_path / "x.zarr", chunk=1, **arguments)
    assert list(tmp_path.iterdir()) == []


# ----------------------------------------------------------------------------------- interruption


@pytest.mark.parametrize("cores", [1, 2])
def test_kernels_can_be_stopped(monkeypatch, cores):
    monkeypatch.setattr(dispatch, "cores", lambda: cores)
    slider = SLIDER.replace(K=xarray.DataArray(np.linspace(7e8, 8e8, 20), dims="K"))
    loading, stop = rs.Loading.steps("10 mm/s", (0.01, "0.1 m/s")), threading.Event()
    timer = threading.Timer(0.3, stop.set)
    timer.start()
    with backend.use(stop=stop), pytest.raises(backend.Stopped):
        rs.simulate(slider, loading, 1e4)
    timer.join()
    with backend.use():
        rs.simulate(slider, loading, 1e-3, V_start=9e-3)  # another place knows nothing of it


@pytest.mark.parametrize(
    ("kind", "numbers", "threads"),
    [("cpu", [0, 1, 2], 2), ("cpu", [1], 6), ("cuda", [0, 1, 2], 6)],  # a GPU has one at a time
)
def test_threads_share_the_cores(monkeypatch, kind, numbers, threads):
    monkeypatch.setattr(tasks, "cores", lambda: 6)
    seen, stops = [], []

    class Tasks:
        device, chunks = kind, Chunks({"M": 3}, (1,))

        def solve(self, i, part, progress, threads, stop):
            seen.append((i, part.batch.n, threads))
            stops.append((stop, stop.is_set()))
            progress(1.0)
            return Outcome(i, 0, None)

    class Report:
        def part(self, i, fraction):
            pass

        refresh = staticmethod(lambda: None)

    call = call_of("limit_cycle", SLIDER, {"V_lp": 1e-3})[1]
    found = list(tasks.Threads("cpu").outcomes(Tasks(), call, numbers, Report()))
    assert sorted(outcome.chunk for outcome in found) == numbers
    assert sorted(seen) == [(i, 1, threads) for i in numbers]
    # in the end, and so if it is interrupted, kernels at work are told to stop
    assert all(stop.is_set() and not before for stop, before in stops)


# --------------------------------------------------------------------------------------- progress


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0, "0 s"),
        (40.4, "40 s"),
        (200.0, "3 min 20 s"),
        (18_600.0, "5 h 10 min"),
        (2 * 86_400 + 3 * 3600 + 59.0, "2 d 3 h"),
    ],
)
def test_durations(seconds, words):
    assert duration(seconds) == words


def test_lines_of_a_progress_report(monkeypatch, capsys):
    clock = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock[0])
    done = np.array([True, False, False, False])
    with progress.ProgressReport("sweep", Chunks({"M": 40}, (10,)), done, 3, quiet=False) as report:
        clock[0] += 0.5
        report.refresh()
        assert capsys.readouterr().err == ""
        clock[0] += 30.0
        report.part(1, 0.5)
        report.finished(Outcome(2, 4, None))
        assert capsys.readouterr().err == (
            "sweep: 25 of 40 cases, 7 failed, 0.492 cases/s, 30 s left\n"
        )
        report.finished(Outcome(1, 0, None))
        assert capsys.readouterr().err == ""  # not so soon again
        clock[0] += 31.0
        report.refresh()
        assert "30 of 40 cases, 7 failed" in capsys.readouterr().err


def test_a_sweep_with_progress_false_prints_nothing(capfd):
    sweep("stability", V_lp=V_LP, progress=False)
    assert capfd.readouterr() == ("", "")


def test_a_bar_is_drawn_on_a_terminal(monkeypatch):
    pty = pytest.importorskip("pty")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("ratestate.dynamics.progress.PATIENCE", 0.0)
    slider = SLIDER.replace(M=rs.logspace("M", 100, 1e5, 40))
    parent, child = pty.openpty()
    with os.fdopen(child, "w") as terminal, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", terminal)
        sweep("stability", slider, V_lp=rs.logspace("V_lp", 1e-2, 1e-1, 40), progress=True)
    text = b""
    with contextlib.suppress(OSError):  # the end, on Linux
        while piece := os.read(parent, 10_000):
            text += piece
    os.close(parent)
    assert b"of 1,600 cases, 0 failed" in text
    assert b"cases/s" in text
