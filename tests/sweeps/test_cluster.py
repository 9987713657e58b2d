"""Sweeps on a Dask cluster: the same bits as here, whatever happens to workers."""

import contextlib
import json
import os
import pickle
import shutil
import signal
import sys
import threading
import time
import types

import pytest
import xarray
from misbehaving import Deadly, Slow
from user_laws import MINE

import ratestate as rs
from ratestate.dynamics.cycles.limit_cycle import LimitCycleCall, limit_cycle, limit_cycle_call
from ratestate.dynamics.results import versions
from ratestate.errors import StoreError
from ratestate.model.arrays import isel
from ratestate.sweeps import calls, cluster, identity, progress
from ratestate.sweeps import sweep as sweep_module
from ratestate.sweeps.chunks import chunks_of
from ratestate.sweeps.status import store_status

pytestmark = pytest.mark.usefixtures("in_time")

M = rs.logspace("M", 1e2, 1e5, 24)
V_LP = rs.logspace("V_lp", 2e-3, 1e-1, 2)
SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=M)
ARGUMENTS = {
    "limit_cycle": {"V_lp": V_LP, "rtol": 1e-6},
    "stability": {"V_lp": V_LP},
    "simulate": {
        "loading": rs.Loading.steps("0.1 mm/s", (0.01, V_LP)),
        "t_end": 0.05,
        "times": [0.0, 0.01, 0.05],
    },
}


@pytest.fixture
def cycles(monkeypatch):
    """Have limit cycles found by another class."""

    def by(kind):
        def call(slider, V_lp, **settings):
            return kind(**vars(limit_cycle_call(slider, V_lp, **settings)))

        monkeypatch.setitem(calls.FUNCTIONS, "limit_cycle", (limit_cycle, call))

    return by


#: beside Dask, what workers have imported before they are forked
IMPORTED = ["ratestate.sweeps.tasks", "ratestate.sweeps.calls"]


@pytest.fixture(scope="module")
def client():
    import dask
    from distributed import Client, LocalCluster
    from distributed.utils import get_mp_context

    settings = {
        # A worker of a LocalCluster that is seen to be down twice within 15 s is given up.
        "distributed.deploy.lost-worker-timeout": "1h",
        # Workers, and those that come for the dead, are forks of a process that has imported much.
        "distributed.worker.multiprocessing-method": "forkserver",
        # A chunk may kill one worker (three, unless this is set).
        "distributed.scheduler.allowed-failures": 1,
    }
    with dask.config.set(settings):
        get_mp_context().set_forkserver_preload(["distributed.nanny", *IMPORTED])
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs="CRITICAL"
        ) as workers,
        Client(workers) as client,
    ):
        yield client


@contextlib.contextmanager
def local_cluster(n_workers):
    """A client, not the default one, of workers that are threads of this process."""
    from distributed import Client, LocalCluster

    with (
        LocalCluster(
            n_workers=n_workers,
            threads_per_worker=1,
            processes=False,
            dashboard_address=":0",
            silence_logs="CRITICAL",
        ) as workers,
        Client(workers, set_as_default=False) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def alone():
    """What the sweep of limit cycles finds without a cluster."""
    return sweep("limit_cycle")


def sweep(function, **how):
    return rs.sweep(function, SLIDER, **ARGUMENTS[function] | {"progress": False} | how)


@contextlib.contextmanager
def meanwhile(do, when=lambda: True):
    """Do something in another thread once `when()` holds."""

    def work():
        while not when() and not over.is_set():
            time.sleep(0.02)
        if not over.is_set():
            do()

    over, thread = threading.Event(), threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@pytest.fixture
def once_done(monkeypatch):
    """Do something, in the thread of a sweep, once so many of its cases are done."""

    def arrange(cases, do):
        finished = progress.ProgressReport.finished

        def look(report, outcome):
            finished(report, outcome)
            if report.done >= cases:
                monkeypatch.setattr(progress.ProgressReport, "finished", finished)
                do()

        monkeypatch.setattr(progress.ProgressReport, "finished", look)

    return arrange


@pytest.fixture(autouse=True)
def often(monkeypatch):
    """Look after workers all the time."""
    monkeypatch.setattr(cluster, "COUNT_INTERVAL", 0.05)


def deaths(client):
    """How many workers have died so far."""
    events = [message for _, message in client.get_events("all")]
    return sum(event["action"] == "remove-worker" for event in events)


# ---------------------------------------------------------------------------------------- same bits


@pytest.mark.parametrize(
    ("function", "store"), [("limit_cycle", False), ("simulate", False), ("stability", True)]
)
def test_a_cluster_gives_the_same_bits_as_this_process(client, function, store, tmp_path):
    path = tmp_path / "x.zarr" if store else None
    found = sweep(function, client=client, chunk=9, store=path)
    xarray.testing.assert_identical(found.load(), sweep(function))


def test_workers_are_given_a_users_law(client, law_file):
    """By its source: its file may be gone."""
    path = law_file(MINE)
    slider = SLIDER.replace(law=rs.register(path), m=xarray.DataArray([1.0, 1.5], dims="m"))
    path.unlink()
    how = {"V_lp": 3e-3, "progress": False}
    here = rs.sweep("stability", slider, **how)
    assert "@" in json.loads(here.attrs["scenario"])["slider"]["law"]
    found = rs.sweep("stability", slider, client=client, chunk=5, **how)
    xarray.testing.assert_identical(found.load(), here)


def test_a_cluster_chooses_the_chunk_size_by_itself(client, alone):
    xarray.testing.assert_identical(sweep("limit_cycle", client=client), alone)


def test_a_task_is_sent_with_its_own_cases_only():
    slider = SLIDER.replace(M=rs.logspace("M", 1e2, 1e5, 1_000_000))
    name, call = calls.call_of("limit_cycle", slider, {"V_lp": 1e-3})
    part = isel(call, chunks_of(call.batch.sizes, 1000).slices(500))
    assert 16_000 < len(pickle.dumps(part)) < 20_000  # values and coordinates, and little else
    assert name == "limit_cycle"


# --------------------------------------------------------------------------------- workers that die


def test_a_killed_worker_costs_nothing(client, cycles, alone, once_done):
    cycles(Slow)
    before = deaths(client)

    def kill():
        pids, tasks = client.run(os.getpid), client.processing()
        os.kill(pids[max(pids, key=lambda worker: len(tasks[worker]))], signal.SIGKILL)

    once_done(4, kill)
    found = sweep("limit_cycle", client=client, chunk=4)
    assert deaths(client) == before + 1
    xarray.testing.assert_identical(found, alone)


def test_cases_that_kill_several_workers_end_the_sweep(client, cycles, alone, tmp_path):
    cycles(Deadly)
    path = tmp_path / "x.zarr"
    with pytest.raises(rs.SolverError, match="Several workers died with the same cases"):
        sweep("limit_cycle", client=client, chunk=4, store=path)
    cycles(LimitCycleCall)
    xarray.testing.assert_identical(sweep("limit_cycle", store=path).load(), alone)


# --------------------------------------------------------------------------- a cluster that is lost


def test_a_cluster_that_closes(cycles, alone, once_done, tmp_path):
    cycles(Slow)
    path = tmp_path / "x.zarr"
    with local_cluster(1) as client:
        once_done(8, client.cluster.close)
        with pytest.raises(rs.SolverError, match=r"cluster is lost .* Run the same sweep again"):
            sweep("limit_cycle", client=client, chunk=4, store=path)
    assert 8 <= store_status(path).done < 48
    cycles(LimitCycleCall)
    xarray.testing.assert_identical(sweep("limit_cycle", store=path).load(), alone)


def test_an_interrupt_ends_a_sweep_on_a_cluster_soon(client, cycles, alone, once_done, tmp_path):
    cycles(Slow)
    path, times = tmp_path / "x.zarr", []

    def interrupt():
        times.append(time.monotonic())
        raise KeyboardInterrupt

    once_done(8, interrupt)
    with pytest.raises(KeyboardInterrupt):
        sweep("limit_cycle", client=client, chunk=4, store=path)
    assert time.monotonic() - times[0] < 5.0
    while client.run_on_scheduler(lambda dask_scheduler: len(dask_scheduler.tasks)):
        assert time.monotonic() - times[0] < 20.0, "tasks are left on the scheduler"
        time.sleep(0.02)
    assert 8 <= store_status(path).done < 48
    cycles(LimitCycleCall)
    found = sweep("limit_cycle", client=client, store=path)
    xarray.testing.assert_identical(found.load(), alone)


def test_without_workers_it_waits_until_they_come(cycles, alone, monkeypatch, capfd):
    cycles(Slow)
    monkeypatch.setattr(cluster, "PATIENCE", 0.1)
    said = "ratestate: the cluster has no workers. Waiting for some ...\n"
    Slow.most, look, heard = 0, cluster.Cluster._count_threads, []

    def interrupt(work):
        heard.append(capfd.readouterr().err)
        if len(heard) > 8 and said in heard:
            raise KeyboardInterrupt
        return look(work)

    with local_cluster(0) as client:
        monkeypatch.setattr(cluster.Cluster, "_count_threads", interrupt)
        with pytest.raises(KeyboardInterrupt):
            sweep("limit_cycle", client=client, chunk=4)
        monkeypatch.setattr(cluster.Cluster, "_count_threads", look)
        assert "".join(heard) == said
        with meanwhile(lambda: client.cluster.scale(4), lambda: capfd.readouterr().err == said):
            found = sweep("limit_cycle", client=client, chunk=2)
    xarray.testing.assert_identical(found, alone)
    assert Slow.most == 4  # those that came late have work too


# ---------------------------------------------------------------------------------- what is refused


def test_workers_of_another_version_are_refused(client, monkeypatch):
    other = json.loads(versions()) | {"numpy": "1.0"}
    monkeypatch.setattr(cluster, "versions", lambda: json.dumps(other))
    with pytest.raises(StoreError, match=r"(?s)A worker has other.*numpy: 1\.0 .*, 2\..* now"):
        sweep("limit_cycle", client=client)


def test_workers_of_two_kinds_are_refused(client, monkeypatch):
    """The one that was asked first is of another kind than those that work."""
    first = identity.origin("cpu")
    first["processor"] |= {"cpu": "i386"}
    monkeypatch.setattr(sweep_module, "origin", {"cpu": first}.get)  # which workers can be sent
    with pytest.raises(StoreError, match=r"(?s)Use workers of one kind.*processor, cpu: i386"):
        sweep("stability", client=client, chunk=24)


def test_workers_that_lack_a_program_are_refused(client, cycles, monkeypatch):
    module = types.ModuleType("only_here")
    monkeypatch.setitem(sys.modules, "only_here", module)
    module.Here = type("Here", (LimitCycleCall,), {"__module__": "only_here"})
    cycles(module.Here)
    with pytest.raises(rs.SolverError, match=r"only_here.*Install the same programs"):
        sweep("limit_cycle", client=client, chunk=8)


def test_a_store_that_workers_cannot_write_to(client, cycles, alone, once_done, tmp_path):
    cycles(Slow)
    path, moved = tmp_path / "x.zarr", tmp_path / "y.zarr"
    once_done(8, lambda: path.rename(moved))
    with pytest.raises(StoreError, match=r"x\.zarr or a part of it was removed"):
        sweep("limit_cycle", client=client, chunk=4, store=path)
    while any(client.processing().values()):
        time.sleep(0.02)
    shutil.rmtree(path, ignore_errors=True)
    moved.rename(path)
    cycles(LimitCycleCall)
    xarray.testing.assert_identical(sweep("limit_cycle", store=path).load(), alone)
