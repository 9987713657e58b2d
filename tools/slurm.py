"""`make slurm`: a sweep in jobs of a real SLURM; some are cancelled, some run out of time.

SLURM is set up from nothing, as one node on this machine (`slurm_node`), and goes in the end.  Each
scene is a sweep whose store must end up as that of a local one, file by file, byte by byte, or
which must end with an error that says what to do, and be resumed then.
"""

import argparse
import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rich.console import Console
from slurm_node import missing, one_node
from torture import chunks_done, contents

import ratestate as rs
from ratestate.scenario.files import load

CONSOLE = Console(highlight=False, soft_wrap=True)
COMMAND = [
    sys.executable,
    "-c",
    "from ratestate.interfaces.cli import main; main()",
    "sweep",
    "rig.toml",
]
SCENARIO = """
[slider]
a = 0.003
b = 0.006
sigma = "2 MPa"
Dc = "10 um"
[sweep]
function = "limit_cycle"
K = {{ from = "0.5 GPa/m", to = "1.2 GPa/m", n = 10, scale = "log" }}
V_lp = {{ from = "0.1 mm/s", to = "0.1 m/s", n = 10, scale = "log" }}
M = {{ from = 100, to = 10000, n = {masses}, scale = "log" }}
"""
# Small chunks take long for what they do: their files are forced to the disk.
CHUNK = 10
JOB = "cores=1,memory=1GB,walltime=00:05:00"
PATIENCE = 400.0  # seconds


class Sweep:
    """The command, in a folder of its own, with so many jobs, and its site's settings."""

    def __init__(self, folder, scenario, slurm, **site):
        folder.mkdir(exist_ok=True)
        self.folder, self.store = folder, folder / "rig.zarr"
        (folder / "rig.toml").write_text(scenario)
        options = ["--store", "rig.zarr", "--chunk", str(CHUNK)]
        options += ["--slurm", slurm] if slurm else []
        CONSOLE.print(f"[bold]$ ratestate sweep rig.toml {' '.join(options)}[/bold]")
        self.log = folder / "log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [*COMMAND, *options],
                cwd=folder,
                stdout=log,
                stderr=log,
                env=os.environ | {f"DASK_JOBQUEUE__SLURM__{key}": site[key] for key in site},
            )

    def until(self, condition):
        """Wait until this is so; AssertionError if the sweep ends before."""
        begin = time.monotonic()
        while not condition():
            assert self.process.poll() is None, f"it has ended: {self.log.read_text()}"
            assert time.monotonic() - begin < PATIENCE, f"this takes long: {self.log.read_text()}"
            time.sleep(0.1)

    def end(self, code=0):
        """Wait for its end; what it wrote.  AssertionError unless it ends with this code."""
        try:
            found = self.process.wait(PATIENCE)
        finally:
            self.process.kill()
        text = self.log.read_text()
        CONSOLE.print(text, end="", markup=False)
        assert found == code, f"it ended with {found}, not {code}"
        return text

    def done(self):
        """How many chunks are done."""
        return len(chunks_done(self.store))


def jobs(state):
    """Ids of the jobs in this state."""
    command = ["squeue", "--noheader", "--format=%i", f"--states={state}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


def cancelled(folder, scenario, expected):
    """One of two jobs is cancelled midway; another replaces it."""
    sweep = Sweep(folder, scenario, f"jobs=2,{JOB}")
    sweep.until(lambda: sweep.done() > 30)
    first = jobs("RUNNING")[0]
    CONSOLE.print(f"{sweep.done()} chunks are done: scancel {first}")
    subprocess.run(["scancel", first], check=True)
    text = sweep.end()
    assert f"SLURM jobs lost: job {first} (CANCELLED). Replacements submitted: 1." in text
    assert contents(sweep.store) == expected


def out_of_time(folder, scenario, expected):
    """The only job reaches its time limit, and must not be replaced; `rs.sweep` resumes."""
    # SLURM knows minutes, and looks every half: the worker comes when much of that is over.
    slurm = "jobs=1,cores=1,memory=1GB,walltime=00:01:00,replacements=0"
    sweep = Sweep(folder, scenario, slurm, JOB_SCRIPT_PROLOGUE='["sleep 40"]')
    text = sweep.end(code=2)
    lost = r"SLURM jobs lost: job \d+ \(TIMEOUT, TimeLimit\)\. Replacements submitted: 0\."
    assert re.search(lost, text)
    assert re.search(r"error: No SLURM job is left.* more replacements=N", text)
    done = sweep.done()
    chunks = sum(name.startswith("status/c/") for name in expected)
    assert 0 < done < chunks, f"a part must be done by then, not {done} of {chunks} chunks"
    CONSOLE.print(f"{done} chunks are done; rs.sweep(..., slurm='jobs=2,{JOB}') goes on")
    marks = [sweep.store / "status/c" / block for block in chunks_done(sweep.store)]
    stamps = {path: path.stat().st_mtime_ns for path in marks}
    asked = load(folder / "rig.toml")
    with contextlib.chdir(folder):
        how = {"slurm": f"jobs=2,{JOB}", "store": "rig.zarr", "chunk": CHUNK}
        rs.sweep(asked.function, asked.slider, **asked.settings, **how)
    assert all(path.stat().st_mtime_ns == stamp for path, stamp in stamps.items())
    assert contents(sweep.store) == expected


def handed_over(folder, scenario, expected):
    """Workers retire before their job's time is over, as jobqueue.yaml says; others go on."""
    sweep = Sweep(
        folder,
        scenario,
        f"jobs=2,{JOB}",
        WORKER_EXTRA_ARGS='["--lifetime", "40s", "--lifetime-stagger", "5s"]',
    )
    text = sweep.end()
    assert re.search(r"SLURM jobs lost: job \d+ \(COMPLETED\)", text)
    assert contents(sweep.store) == expected


def never_started(folder, scenario, expected):
    """The queue starts no job."""
    text = Sweep(folder, scenario, f"queue=closed,wait=00:00:20,{JOB}").end(code=2)
    assert re.search(r"No worker has come for 20 s: job \d+ \(PENDING, PartitionDown\)", text)


def dead_at_once(folder, scenario, expected):
    """Jobs end before their workers come."""
    prologue = '["echo no such module; exit 1"]'
    text = Sweep(folder, scenario, f"jobs=3,{JOB}", JOB_SCRIPT_PROLOGUE=prologue).end(code=2)
    assert "All SLURM jobs were lost before a worker came. The last was job" in text


SCENES = (cancelled, out_of_time, handed_over, never_started, dead_at_once)


def main():
    parser = argparse.ArgumentParser(description="Sweep in jobs of a real SLURM.")
    parser.add_argument("--cases", type=int, default=6000, help="how many; 6000 by default")
    parser.add_argument("--scenes", default="", help="a part of the names of those to do")
    options = parser.parse_args()
    if lacking := missing():
        sys.exit(f"error: no {', '.join(lacking)} here; on Debian: apt install slurm-wlm munge")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))  # and the daemons with it
    begin = time.monotonic()
    scenario = SCENARIO.format(masses=options.cases // 100)
    with tempfile.TemporaryDirectory(prefix="ratestate-slurm-") as name:
        folder = Path(name)
        local = Sweep(folder / "local", scenario, "")
        local.end()
        expected = contents(local.store)
        for scene in SCENES:
            if options.scenes in scene.__name__:
                CONSOLE.print(f"\n[bold]{scene.__doc__.splitlines()[0]}[/bold]")
                with one_node(cpus=2, memory=2000):
                    scene(folder / scene.__name__, scenario, expected)
    CONSOLE.print(f"\nall as it should be, in {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main()
