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
from pathlib import Path
from typing import NamedTuple

import pytest
import xarray as xr
from command_line import call

import ratestate as rs
from ratestate import ParameterError, files
from ratestate.sweeps.status import store_status

SCENARIO = """
[slider]
a = 0.003
b = 0.006
Dc = "10 um"
sigma = "2 MPa"
K = "900 MPa/m"
[sweep]
function = "limit_cycle"
M = { from = 100, to = 1e4, n = 3, scale = "log" }
V_lp = ["1 mm/s", "10 mm/s"]
"""


class StoreStatus(NamedTuple):
    path: Path
    function: str = "limit_cycle"
    dims: dict = {"M": 3, "V_lp": 2}  # noqa: RUF012
    cases: int = 6
    done: int = 6
    failed: int = 0
    steady: int = 2
    chunks: int = 3
    chunks_done: int = 3
    versions: dict = {"ratestate": "0.1.0", "numpy": "2.3.0"}  # noqa: RUF012
    size: int = 123_456
    processor: str = ""
    flaws: list | None = None


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "it.toml"
    path.write_text(SCENARIO)
    return path


@pytest.fixture
def sweeps(monkeypatch, tmp_path):
    """Stand-ins for sweeps and clusters: `requests` lists the calls; the rest may be changed."""
    seen = types.SimpleNamespace(
        requests=[], status=StoreStatus(tmp_path / "x.zarr"), failures=[], ends=lambda: None
    )

    def sweep(function, slider, **arguments):
        seen.requests.append((function, slider, arguments))
        seen.ends()
        return xr.Dataset({"status": ((), 0)}, attrs={"slider": "{}"})

    def store_status(store, verify=False):
        if seen.status is None:
            raise ParameterError(f"{store} is no store")
        return seen.status

    def failures(data, most):
        return seen.failures[:most], len(seen.failures)

    class Cluster:
        def __init__(self, options):
            self.options = options

        def job_script(self):
            return f"#SBATCH {self.options}"

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

    def client(address, timeout):
        return contextlib.nullcontext(address)

    stand_ins = {
        "sweep": {"sweep": sweep},
        "status": {"store_status": store_status, "failures": failures},
        "slurm": {"job_cluster": Cluster},
        "cluster": {"import_extra": lambda module: types.SimpleNamespace(Client=client)},
    }
    for name, functions in stand_ins.items():
        module = types.ModuleType(f"ratestate.sweeps.{name}")
        vars(module).update(functions)
        monkeypatch.setitem(sys.modules, module.__name__, module)
    return seen


def test_the_file_s_sweep_is_run(sweeps, file, tmp_path):
    result = call("sweep", file, "--store", tmp_path / "x.zarr")
    assert result.exit_code == 0, result.output
    ((function, slider, arguments),) = sweeps.requests
    assert function == "limit_cycle"
    assert slider.M.values.tolist() == [100.0, 1000.0, 10000.0]
    assert arguments.pop("V_lp").values.tolist() == [0.001, 0.01]
    assert arguments == {
        "store": tmp_path / "x.zarr",
        "client": None,
        "slurm": None,
        "chunk": None,
        "progress": True,
        "device": "cpu",
    }
    assert result.stdout == f"6 cases in {tmp_path}/x.zarr: 4 cycles, 2 steady sliding, 0 failed\n"


def test_options_reach_the_sweep(sweeps, file, tmp_path):
    store = ["--store", tmp_path / "x.zarr"]
    assert call("sweep", file, *store, "--chunk", 7, "--device", "cuda").exit_code == 0
    assert call("sweep", file, *store, "--scheduler", "tcp://node1:8786").exit_code == 0
    assert call("sweep", file, *store, "--slurm", "jobs=2,cores=4").exit_code == 0
    first, second, third = (arguments for _, _, arguments in sweeps.requests)
    assert (first["chunk"], first["device"], first["client"]) == (7, "cuda", None)
    assert (second["client"], second["slurm"]) == ("tcp://node1:8786", None)
    assert (third["client"], third["slurm"]) == (None, "jobs=2,cores=4")


def test_some_failed(sweeps, file, tmp_path):
    sweeps.status = sweeps.status._replace(failed=22, steady=1, cases=40, done=40)
    sweeps.failures = [({"M": 100.0 * i, "V_lp": 0.0032}, "step_limit", "why") for i in range(22)]
    result = call("sweep", file, "--store", tmp_path / "x.zarr")
    assert result.exit_code == 3
    title, *lines = result.stdout.splitlines()
    assert title.endswith("x.zarr: 17 cycles, 1 steady sliding, 22 failed")
    assert len(lines) == 21
    assert lines[1] == "  M = 100 kg/m^2, V_lp = 3.2 mm/s: step_limit: why"
    assert lines[-1] == "  and 2 more"


def test_summary_of_other_verbs(sweeps, file, tmp_path):
    sweeps.status = sweeps.status._replace(function="simulate", steady=0, done=5)
    result = call("sweep", file, "--store", tmp_path / "x.zarr")
    assert result.stdout.endswith("x.zarr: 5 finished, 0 failed, 1 not done\n")


def test_ctrl_c(sweeps, file, tmp_path):
    def interrupt():
        raise KeyboardInterrupt

    sweeps.ends, sweeps.status = interrupt, sweeps.status._replace(done=4)
    store = tmp_path / "x.zarr"
    result = call("sweep", file, "--store", store)
    assert result.exit_code == 130
    last = result.stderr.splitlines()[-1]
    assert (
        last == f"interrupted: nothing is stored in {store} yet, and the same command starts again"
    )
    store.mkdir()
    result = call("sweep", file, "--store", store)
    assert result.exit_code == 130
    last = result.stderr.splitlines()[-1]
    assert last == (
        f"interrupted: 4 of 6 cases are stored in {store}, and the same command resumes"
    )
    sweeps.status = None
    result = call("sweep", file, "--store", store)
    assert result.exit_code == 130
    last = result.stderr.splitlines()[-1]
    assert last == f"interrupted: what was done is stored in {store}, and the same command resumes"


def test_a_file_with_problems_starts_nothing(sweeps, file):
    file.write_text(SCENARIO.replace("mm/s", "mm").replace("sigma", "sgima"))
    result = call("sweep", file, "--store", "x.zarr", "--slurm", "jobs=2")
    assert result.exit_code == 2
    title, *lines = result.stderr.splitlines()
    assert re.fullmatch(r"error: .*it.toml cannot be used:", title)
    expected = [
        r"line \d+, \[slider\] sigma: is missing\. .*",
        r"line \d+, \[slider\] sgima: .* Did you mean sigma\?",
        r"line \d+, \[sweep\] V_lp\[0\]: '1 mm' is a length\. .*",
    ]
    for line, pattern in zip(lines, expected, strict=True):
        assert re.fullmatch(pattern, line)
    assert sweeps.requests == []


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["it.toml"], "--store"),
        (["--store", "x"], "FILE.toml"),
        (["it.toml", "--store", "x", "--chunk", "0"], "--chunk"),
        (["it.toml", "--store", "x", "--device", "tpu"], "--device"),
        (["it.toml", "--store", "x", "--job-script"], "--job-script"),
        (["it.toml", "--store", "x", "--slurm", "jobs=1", "--scheduler", "tcp://a:1"], "--slurm"),
    ],
)
def test_usage(sweeps, arguments, named):
    result = call("sweep", *arguments)
    assert result.exit_code == 2
    assert named in result.stderr
    assert sweeps.requests == []


def test_the_job_script_is_printed_and_nothing_run(sweeps, file):
    result = call("sweep", file, "--store", "x", "--slurm", "jobs=2,cores=4", "--job-script")
    assert result.exit_code == 0
    assert result.stdout == "#SBATCH jobs=2,cores=4\n"
    assert sweeps.requests == []


def test_status(sweeps, tmp_path):
    sweeps.status = sweeps.status._replace(done=4, chunks_done=2, failed=1)
    result = call("sweep", "--store", tmp_path / "x.zarr", "--status")
    assert result.exit_code == 0, result.output
    assert (
        result.stdout
        == f"""\
store     {tmp_path}/x.zarr
function  limit_cycle
axes      M (3), V_lp (2)
cases     6
done      4 (66 %)
failed    1
steady    2
chunks    2 of 3
versions  ratestate 0.1.0, numpy 2.3.0
size      123 kB
"""
    )
    assert sweeps.requests == []


@pytest.mark.parametrize(
    ("size", "text"),
    [(0, "0 B"), (999, "999 B"), (1000, "1 kB"), (2_345_678_901_234, "2.35e+03 GB")],
)
def test_sizes(sweeps, size, text):
    sweeps.status = sweeps.status._replace(size=size)
    assert call("sweep", "--store", "x", "--status").stdout.splitlines()[-1] == f"size      {text}"


def test_verify(sweeps, tmp_path):
    result = call("sweep", "--store", tmp_path / "x.zarr", "--verify")
    assert result.exit_code == 2
    assert "it needs --status" in result.stderr
    sweeps.status = sweeps.status._replace(flaws=[])
    result = call("sweep", "--store", tmp_path / "x.zarr", "--status", "--verify")
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == "verified  all files are intact"


def test_a_sweep_from_file_to_store(file, tmp_path):
    store = tmp_path / "x.zarr"
    for _ in range(2):  # the second finds all done
        result = call("sweep", file, "--store", store)
        assert result.exit_code == 0, result.output
        assert result.stdout == f"6 cases in {store}: 2 cycles, 4 steady sliding, 0 failed\n"
    found = xr.open_zarr(store, chunks=None)
    slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m")
    slider = slider.replace(M=rs.logspace("M", 100, 1e4, 3))
    cycle = rs.limit_cycle(slider, rs.logspace("V_lp", 1e-3, 1e-2, 2))
    xr.testing.assert_equal(found.drop_vars("message"), cycle)


def test_files_pictures_and_json_of_a_store(file, tmp_path):
    store, out, plot = (tmp_path / name for name in ("x.zarr", "x.nc", "x.png"))
    file.write_text(
        SCENARIO.replace("M = {", 'K = ["500 MPa/m", inf]\n#').replace(
            "[slider]", "[slider]\nM = 0"
        )
    )
    file.write_text(file.read_text().replace('K = "900 MPa/m"\n', ""))
    result = call("sweep", file, "--store", store, "--out", out, "--plot", plot, "--json")
    assert result.exit_code == 3, result.output
    assert result.stderr == f"wrote {out}\nwrote {plot}\n"
    told = json.loads(result.stdout)
    assert (told["path"], told["cases"], told["failed"], told["steady"]) == (str(store), 4, 2, 2)
    assert told["failures"][0]["at"] == {"K": 5e8, "V_lp": 1e-3}
    assert told["failures"][0]["status"] == "quasi_static_instability"
    assert told["failures"][0]["message"].startswith("V grows without bound")
    xr.testing.assert_equal(files.read(out), files.read(store))
    assert plot.read_bytes()[:4] == b"\x89PNG"
    told = json.loads(call("sweep", "--store", store, "--status", "--json", file).stdout)
    assert (told["done"], told["differences"]) == (4, [])


def test_status_compares_the_file_with_the_store(file, tmp_path):
    store = tmp_path / "x.zarr"
    assert call("sweep", file, "--store", store).exit_code == 0
    status = ["sweep", "--store", store, "--status"]
    result = call(*status, file)
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines()[-1] == f"file      {file} asks for this very sweep"
    assert result.stdout.startswith(call(*status).stdout)
    file.write_text(SCENARIO.replace("0.006", "0.007").replace("10 mm/s", "20 mm/s"))
    result = call(*status, file)
    assert result.exit_code == 0
    *_, title, one, two = result.stdout.splitlines()
    assert title == f"file      {file} asks for another sweep:"
    assert one.startswith("  V_lp: <V_lp: 2; 0.001 to 0.01 m/s; SHA-256 ")
    assert two.startswith("  b: 0.006 in the store, 0.007")
    result = call("sweep", file, "--store", store)
    assert result.exit_code == 2
    assert f"error: {store} holds another sweep" in result.stderr
    assert one in result.stderr


def test_ctrl_c_ends_a_real_sweep(file, tmp_path):
    store = tmp_path / "x.zarr"
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
        f"interrupted: {done} of 60000 cases are stored in {store}, and the same command resumes\n"
    )


@pytest.mark.skipif(os.name != "posix", reason="a stand-in for sbatch is a shell script")
def test_the_job_script_is_not_submitted(file, monkeypatch, tmp_path):
    pytest.importorskip("dask_jobqueue")
    sbatch = tmp_path / "sbatch"
    sbatch.write_text(f"#!/bin/sh\necho $@ >> {tmp_path}/submitted\necho job 17\n")
    sbatch.chmod(0o700)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    options = "jobs=2,cores=4,memory=8GB,walltime=02:00:00,queue=short"
    result = call("sweep", "--store", "x", "--slurm", options, "--job-script")
    assert result.exit_code == 0, result.output
    for line in ("-p short", "--cpus-per-task=4", "-t 02:00:00"):
        assert f"#SBATCH {line}\n" in result.stdout
    assert not (tmp_path / "submitted").exists()
    result = call("sweep", "--store", "x", "--slurm", "cores=four", "--job-script")
    assert result.exit_code == 2
    assert result.stderr.startswith("error: slurm: cores = four is not an integer")
