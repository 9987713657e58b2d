"""``ratestate sweep``: what it asks of sweeps, what it says and what it returns."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import types

import pytest
import xarray as xr
from command_line import call, refuse, succeed
from scenario_files import SLIDER

import ratestate as rs
from ratestate import files
from ratestate.sweeps.status import store_status

SCENARIO = f"""{SLIDER}[sweep]
function = "limit_cycle"
M = {{ from = 100, to = 1e4, n = 3, scale = "log" }}
V_lp = ["1 mm/s", "10 mm/s"]
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "it.toml"
    path.write_text(SCENARIO)
    return path


@pytest.fixture
def store(tmp_path):
    return tmp_path / "x.zarr"


@pytest.fixture
def requests(monkeypatch):
    """Calls of sweeps, each of which is interrupted at once; a client is its address."""
    made = []

    def sweep(function, slider, **arguments):
        made.append((function, slider, arguments))
        raise KeyboardInterrupt

    module = types.SimpleNamespace(Client=lambda address, timeout: contextlib.nullcontext(address))
    monkeypatch.setattr("ratestate.sweeps.sweep.sweep", sweep)
    monkeypatch.setattr("ratestate.sweeps.cluster.import_extra", lambda _: module)
    return made


@pytest.mark.parametrize(
    ("options", "given"),
    [
        ([], {}),
        (["--chunk", 7, "--device", "cuda"], {"chunk": 7, "device": "cuda"}),
        (["--scheduler", "tcp://node1:8786"], {"client": "tcp://node1:8786"}),
        (["--slurm", "jobs=2,cores=4"], {"slurm": "jobs=2,cores=4"}),
    ],
)
def test_file_and_options_reach_the_sweep(options, given, requests, file, store):
    result = call("sweep", file, "--store", store, *options)
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == (
        f"interrupted before the sweep began to compute. Nothing is stored in {store}. Run the "
        f"same sweep again, which starts from the beginning.\n"
    )
    ((function, slider, arguments),) = requests
    assert function == "limit_cycle"
    assert slider.M.values.tolist() == [100.0, 1000.0, 10000.0]
    assert arguments.pop("V_lp").values.tolist() == [0.001, 0.01]
    usual = {"client": None, "slurm": None, "chunk": None, "progress": True, "device": "cpu"}
    assert arguments == usual | {"store": store} | given


def test_from_file_to_store_and_its_status(file, store):
    for _ in range(2):  # the second finds all done
        result = succeed("sweep", file, "--store", store, "--chunk", 2)
        assert result.stdout == f"6 cases in {store}: 2 cycles, 4 steady sliding, 0 failed\n"
    found = xr.open_zarr(store, chunks=None)
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m")
    slider = slider.replace(M=rs.logspace("M", 100, 1e4, 3))
    cycle = rs.limit_cycle(slider, rs.logspace("V_lp", 1e-3, 1e-2, 2))
    xr.testing.assert_equal(found.drop_vars("message"), cycle)
    status = ["sweep", "--store", store, "--status"]
    there = succeed(*status)
    lines = there.stdout.splitlines()
    assert lines[:8] == [
        f"store     {store}",
        "function  limit_cycle",
        "axes      M (3), V_lp (2)",
        "cases     6",
        "done      6 (100 %)",
        "failed    0",
        "steady    4",
        "chunks    3 of 3",
    ]
    assert re.fullmatch(rf"versions  ratestate {rs.__version__}, .*numpy 2\..*", lines[8])
    assert re.fullmatch(r"size      \d+(\.\d+)? kB", lines[9])
    assert call(*status, "--verify").stdout == there.stdout + "verified  all files are intact\n"
    same = call(*status, file)
    assert same.stdout == f"{there.stdout}file      {file} asks for this very sweep\n"
    file.write_text(SCENARIO.replace("0.006", "0.007").replace("10 mm/s", "20 mm/s"))
    result = succeed(*status, file)
    *_, title, one, two = result.stdout.splitlines()
    assert title == f"file      {file} asks for another sweep:"
    assert one.startswith("  V_lp: <V_lp: 2; 0.001 to 0.01 m/s; SHA-256 ")
    assert two.startswith("  b: 0.006 in the store, 0.007")
    result = refuse("sweep", file, "--store", store)
    assert f"error: {store} holds another sweep" in result.stderr
    assert one in result.stderr


def test_failed_cases_files_pictures_and_json_of_a_store(file, store, tmp_path):
    """Without mass a soft spring has no cycle, and a rigid one slides steadily."""
    out, plot = (tmp_path / name for name in ("x.nc", "x.png"))
    axes = 'K = ["500 MPa/m", inf]\nV_lp = { from = 1e-3, to = 1e-2, n = 22 }\n'
    text = SCENARIO.replace('K = "900 MPa/m"', "M = 0").partition("M = {")[0]
    file.write_text(text + axes)
    result = call("sweep", file, "--store", store, "--out", out, "--plot", plot, "--json")
    assert result.exit_code == 3, result.output
    assert result.stderr == f"wrote {out}\nwrote {plot}\n"
    told = json.loads(result.stdout)
    numbers = [told[name] for name in ("path", "cases", "failed", "steady")]
    assert numbers == [str(store), 44, 22, 22]
    assert len(told["failures"]) == 22
    assert told["failures"][0]["at"] == {"K": 5e8, "V_lp": 1e-3}
    assert told["failures"][0]["status"] == "quasi_static_instability"
    assert told["failures"][0]["message"].startswith("V grows without bound")
    xr.testing.assert_equal(files.read(out), files.read(store))
    assert plot.read_bytes()[:4] == b"\x89PNG"
    title, *lines = call("sweep", file, "--store", store).stdout.splitlines()
    assert title.endswith(": 22 steady sliding, 22 failed (quasi static instability)")
    assert len(lines) == 21
    assert lines[0].startswith("  K = 500 MPa/m, V_lp = 1 mm/s: quasi_static_instability: V grows")
    assert lines[-1] == "  and 2 more"
    told = json.loads(call("sweep", "--store", store, "--status", "--json", file).stdout)
    assert (told["done"], told["differences"]) == (44, [])


def test_ctrl_c_ends_a_real_sweep(file, store):
    file.write_text(re.sub("V_lp = .*", "V_lp = {from = 1e-3, to = 1e-2, n = 20_000}", SCENARIO))
    # where SIGINT is ignored, children inherit it
    code = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    code += "from ratestate.interfaces.cli import main; main()"
    command = [sys.executable, "-c", code, "sweep", file, "--store", store, "--chunk", "100"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        until = time.monotonic() + 60.0
        while not any((store / "status").glob("c/*/*")) and process.poll() is None:
            assert time.monotonic() < until
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 130, errors
    done = store_status(store).done
    assert 0 < done < 60_000
    assert errors == (
        f"interrupted. {done} of 60,000 cases are stored in {store}. Run the same sweep again to "
        "compute the others.\n"
    )
    lines = call("sweep", "--store", store, "--status").stdout.splitlines()
    assert f"done      {done} ({done // 600} %)" in lines


@pytest.mark.skipif(os.name != "posix", reason="a stand-in for sbatch is a shell script")
def test_the_job_script_is_printed_and_not_submitted(requests, monkeypatch, tmp_path):
    pytest.importorskip("dask_jobqueue")
    sbatch = tmp_path / "sbatch"
    sbatch.write_text(f"#!/bin/sh\necho $@ >> {tmp_path}/submitted\necho job 17\n")
    sbatch.chmod(0o700)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    options = "jobs=2,cores=4,memory=8GB,walltime=02:00:00,queue=short"
    result = succeed("sweep", "--store", "x", "--slurm", options, "--job-script")
    for line in ("-p short", "--cpus-per-task=4", "-t 02:00:00"):
        assert f"#SBATCH {line}\n" in result.stdout
    assert not (tmp_path / "submitted").exists()
    assert requests == []
