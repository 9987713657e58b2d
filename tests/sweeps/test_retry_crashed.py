"""Faults of the program, not of a case: what ends a sweep, and what is tried again."""

import contextlib

import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import ratestate as rs
from ratestate.dynamics.steady_sliding import StabilityCall, stability_call
from ratestate.engine.model import CRASHED
from ratestate.interfaces.cli import main
from ratestate.sweeps import calls, tasks, writing
from ratestate.sweeps.chunks import Chunks
from ratestate.sweeps.solve import form_of
from ratestate.sweeps.status import store_status

MASSES = xr.DataArray([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], dims="M")
SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=MASSES)
BAD = [2.0, 3.0, 6.0]  # masses; one in each chunk of two


class Broken(StabilityCall):
    """Raises an error for bad cases, or in the compiler."""

    error: type[Exception] = ZeroDivisionError

    def run(self, progress=None):
        if np.isin(self.batch.flat("M"), BAD).any():
            raise self.error("spanner")
        return super().run(progress)


class Uncompiled(Broken):
    error = rs.CompilationError


@contextlib.contextmanager
def broken(how=Broken):
    """Have `stability` done by another class."""

    def call(slider, V_lp):
        return how(**vars(stability_call(slider, V_lp)))

    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(calls.FUNCTIONS, "stability", (rs.stability, call))
        yield


def sweep(path=None, **how):
    return rs.sweep(rs.stability, SLIDER, V_lp=1e-5, store=path, progress=False, chunk=2, **how)


def assert_whole(found):
    assert (found.status == 0).all()
    assert np.array_equal(found.growth_rate, sweep().growth_rate)
    assert (found.message == "").all()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "x.zarr"


def test_crashed_cases_are_tried_again_when_asked(path):
    with broken():
        found = sweep(path)
    assert MASSES[found.status.values == CRASHED].values.tolist() == BAD
    assert "retry_crashed=True (--retry-crashed)" in str(found.message.values[1])
    assert (sweep(path).status == CRASHED).sum() == 3  # not by itself
    assert_whole(sweep(path, retry_crashed=True))
    assert_whole(sweep(path))
    assert (store_status(path).failed, store_status(path).chunks_done) == (0, 3)


def test_only_chunks_with_crashed_cases_are_done_again(path):
    with broken(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(f"{__name__}.BAD", [3.0, 4.0])
        sweep(path)
    files = sorted(path.glob("growth_rate/c/*"))
    before = [file.stat().st_mtime_ns for file in files]
    assert_whole(sweep(path, retry_crashed=True))
    again = [file.stat().st_mtime_ns != old for file, old in zip(files, before, strict=True)]
    assert again == [False, True, False]
    before = [file.stat().st_mtime_ns for file in files]
    assert_whole(sweep(path, retry_crashed=True))  # there are none
    assert [file.stat().st_mtime_ns for file in files] == before


def test_an_interrupted_retry_is_gone_on_with(path, monkeypatch):
    with broken():
        sweep(path)
    write = tasks.write

    def interrupted(store, i, variables):
        if i == 1:
            raise KeyboardInterrupt
        write(store, i, variables)

    with monkeypatch.context() as patch:
        patch.setattr(tasks, "write", interrupted)
        patch.setattr("ratestate.sweeps.tasks.cores", lambda: 1)
        with pytest.raises(KeyboardInterrupt):
            sweep(path, retry_crashed=True)
    assert store_status(path).chunks_done == 1
    assert_whole(sweep(path))


def test_a_retry_without_room_keeps_what_is_there(path, monkeypatch):
    with broken():
        sweep(path)

    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(writing, "_sync", full)
        with pytest.raises(rs.StoreError, match="Make room"):
            sweep(path, retry_crashed=True)
    assert_whole(sweep(path, retry_crashed=True))


def test_a_retry_needs_a_store():
    with pytest.raises(rs.ParameterError, match=r"retry_crashed.*store"):
        sweep(retry_crashed=True)


def test_the_command_tries_again(path, tmp_path):
    file = tmp_path / "x.toml"
    file.write_text(
        "[slider]\na = 0.003\nb = 0.006\nDc = '10 um'\nsigma = '2 MPa'\nK = '0.9 GPa/m'\n"
        "[sweep]\nverb = 'stability'\nV_lp = '10 um/s'\nM = [1.0, 2.0, 3.0]\n"
    )
    command = ["sweep", str(file), "--store", str(path)]
    with broken():
        first = CliRunner().invoke(main, command)
    assert first.exit_code == 3, first.output
    assert "2 failed" in first.stdout
    assert "--retry-crashed" in first.stdout
    assert CliRunner().invoke(main, command).exit_code == 3
    again = CliRunner().invoke(main, [*command, "--retry-crashed"])
    assert again.exit_code == 0
    assert "3 finished, 0 failed" in again.stdout


def test_an_error_of_compiling_ends_a_sweep_and_is_not_stored(path):
    with broken(Uncompiled), pytest.raises(rs.CompilationError, match="spanner"):
        sweep(path)
    assert store_status(path).failed == 0
    assert_whole(sweep(path))


def test_so_it_does_in_a_process_of_its_own(monkeypatch):
    monkeypatch.setattr(tasks, "GRACE", 0.0)
    call = stability_call(SLIDER.replace(M=MASSES[[0, 1, 3]]), 1e-5)
    uncompiled = Uncompiled(**vars(call))
    chunks, specs = Chunks({"M": 3}, (3,)), form_of(call).specs
    apart = tasks.SubprocessTasks(chunks, specs, None, "cpu")
    with pytest.raises(rs.CompilationError, match="spanner"):
        apart.do(0, uncompiled)
