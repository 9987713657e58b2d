"""Cores and memory that this process may use; requests that are too large."""

import os
import re

import numpy as np
import pytest

import ratestate as rs
from ratestate import machine
from ratestate.dynamics import basin


@pytest.fixture
def group(tmp_path, monkeypatch):
    """Write control groups: what /proc says, and files of limits."""

    def write(own, **limits):
        (tmp_path / "own").write_text(own)
        for name, text in limits.items():
            file = tmp_path / "sys" / name.replace("__", "/").replace("_in_", ".")
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        machine._cpu_quotas.cache_clear()

    monkeypatch.setattr(machine, "CGROUP_FILE", tmp_path / "own")
    monkeypatch.setattr(machine, "CGROUP_ROOT", tmp_path / "sys")
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(12)))
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    yield write
    machine._cpu_quotas.cache_clear()


V1 = "5:memory:/job\n4:cpu,cpuacct:/job/step\n3:name=systemd:/user\n"


@pytest.mark.parametrize(
    ("own", "limits", "cores"),
    [
        ("", {}, 12),
        ("0::/\n", {"cpu_in_max": "210000 100000\n"}, 3),
        ("0::/\n", {"cpu_in_max": "10000 100000\n"}, 1),
        ("0::/\n", {"cpu_in_max": "9900000 100000\n"}, 12),
        ("0::/a/b\n", {"a__cpu_in_max": "900000 100000", "a__b__cpu_in_max": "500000 100000"}, 5),
        ("0::/a\n", {"a__cpu_in_max": "what is this"}, 12),
    ],
)
def test_cores_of_a_control_group(group, own, limits, cores):
    group(own, **limits)
    assert machine.cores() == cores


@pytest.mark.parametrize(("quota", "cores"), [("250000", 3), ("-1", 12)])
@pytest.mark.parametrize("at", ["", "/job", "/job/step"])
def test_cores_of_the_first_kind_of_control_groups(group, quota, cores, at, tmp_path):
    group(V1)
    folder = tmp_path / f"sys/cpu,cpuacct{at}"
    folder.mkdir(parents=True)
    (folder / "cpu.cfs_quota_us").write_text(quota)
    (folder / "cpu.cfs_period_us").write_text("100000")
    assert machine.cores() == cores


@pytest.mark.parametrize(("value", "cores"), [("5", 5), ("1", 1), ("40", 12), ("0", 12), ("x", 12)])
def test_cores_by_the_environment(group, monkeypatch, value, cores):
    group("")
    monkeypatch.setenv("NUMBA_NUM_THREADS", value)
    assert machine.cores() == cores


def test_memory(group, tmp_path):
    group("")
    physical = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    assert machine.memory() == physical
    group("0::/a\n", a__memory_in_max="2000000\n")
    assert machine.memory() == 2e6
    group("0::/a\n", a__memory_in_max="max\n")
    assert machine.memory() == physical
    group(V1)
    (tmp_path / "sys/memory/job").mkdir(parents=True)
    (tmp_path / "sys/memory/job/memory.limit_in_bytes").write_text("3000000")
    assert machine.memory() == 3e6


SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3e3)


def test_too_large_a_request_is_refused_with_its_size(monkeypatch):
    monkeypatch.setattr(machine, "memory", lambda: 64e9)
    slider = SLIDER.replace(K=rs.logspace("K", 1e9, 1e10, 10**5))
    loading, times = rs.Loading.constant(1e-3), np.linspace(0, 1, 10**5)
    told = (
        "the results of 100,000 cases at 100,000 times need 800 GB of memory, but the limit is 64"
    )
    with pytest.raises(rs.ParameterError, match=told) as error:
        rs.simulate(slider, loading, 1.0, times=times)
    assert re.search("Save fewer times, or .* store", str(error.value))
    with pytest.raises(rs.ParameterError, match=r"100,000 cases need 56\d GB.*Give a store"):
        rs.sweep(rs.simulate, slider, loading=loading, t_end=1.0, times=times, progress=False)


@pytest.mark.parametrize("function", [rs.limit_cycle, rs.stability, basin.escape, rs.hopf])
def test_more_cases_than_fit_are_refused_before_it_starts(function):
    slider = SLIDER.replace(M=rs.logspace("M", 1.0, 1e4, 10**5))
    with pytest.raises(rs.ParameterError, match=r"results of 10,000,000,000 cases need .* GB"):
        function(slider, V_lp=rs.logspace("V_lp", 1e-4, 1e-2, 10**5))


@pytest.mark.parametrize(("bytes_there", "refused"), [(1599, True), (1600, False)])
def test_the_largest_request_that_fits(monkeypatch, bytes_there, refused):
    monkeypatch.setattr(machine, "memory", lambda: bytes_there)
    slider = SLIDER.replace(K=rs.logspace("K", 1e9, 1e10, 4) * np.inf)

    def run():
        return rs.simulate(slider, rs.Loading.constant(1e-3), 1.0, times=np.linspace(0, 1, 5))

    if refused:
        with pytest.raises(rs.ParameterError, match="4 cases at 5 times"):
            run()
    else:
        assert (run().status == 0).all()
