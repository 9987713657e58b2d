"""Sweeps in SLURM jobs: the script, what the site says, and jobs that are lost; without SLURM."""

import contextlib
import os
import signal
import sys
import time
import types
from pathlib import Path

import dask
import pytest
import xarray
from distributed import Worker
from misbehaving import Held

import ratestate as rs
from ratestate.dynamics.steady_sliding import stability_call
from ratestate.sweeps import calls, cluster
from ratestate.sweeps import slurm as slurm_module
from ratestate.sweeps.slurm import Jobs, job_cluster, squeue

pytestmark = pytest.mark.usefixtures("in_time")

SLIDER = rs.SpringSlider(
    a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=rs.logspace("M", 1e2, 1e5, 90)
)
# Stand-ins for SLURM's programs.  $0's folder has, for each job, a folder with its state; what
# `sbatch` does with a job stands in `answer`: run, wait, fail, or what it says when it refuses.
SBATCH = """\
cd "$(dirname "$0")" && echo "$*" >> asked
case "$(cat answer)" in
    run|wait|fail) ;;
    *) cat answer >&2; exit 1 ;;
esac
job=1
while ! mkdir job$job 2> /dev/null; do job=$((job + 1)); done
cp "$1" job$job/script
case "$(cat answer)" in
    wait) echo PENDING > job$job/state ;;
    fail) echo FAILED > job$job/state ;;
    run) echo RUNNING > job$job/state
         setsid sh job$job/script < /dev/null > job$job/log 2>&1 & echo $! > job$job/group ;;
esac
echo Submitted batch job $job
"""
SQUEUE = """\
cd "$(dirname "$0")" && echo "$*" >> queues
[ ! -e down ] || exit 1
for job in $(echo "$4" | sed 's/--jobs=//; s/,/ /g'); do
    [ ! -e job$job/state ] || echo "$job|$(cat job$job/state)|$(cat reason)"
done
"""
SCANCEL = """\
cd "$(dirname "$0")" && echo CANCELLED > job$1/state
[ ! -e job$1/group ] || kill -TERM -- -$(cat job$1/group)
"""


class Slurm:
    """A stand-in for SLURM, which does with jobs as it is told."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        for name, script in {"sbatch": SBATCH, "squeue": SQUEUE, "scancel": SCANCEL}.items():
            (folder / name).write_text(f"#!/bin/sh\n{script}")
            (folder / name).chmod(0o755)
        self.answer("wait")
        for name, text in {"asked": "", "queues": "", "reason": "None"}.items():
            (folder / name).write_text(text)

    def answer(self, text):
        """Have `sbatch` do this from now on."""
        (self.folder / "answer").write_text(text)

    def say(self, job, state):
        """Have `squeue` say this of a job."""
        (self.folder / f"job{job}" / "state").write_text(state)

    def forget(self, job):
        """Have `squeue` not know a job any more."""
        (self.folder / f"job{job}" / "state").unlink()

    def end(self, job, state="CANCELLED"):
        """End a job, as `scancel` does."""
        self.say(job, state)
        os.killpg(int((self.folder / f"job{job}" / "group").read_text()), signal.SIGTERM)

    @property
    def submitted(self):
        """How many jobs `sbatch` has been asked for."""
        return len((self.folder / "asked").read_text().splitlines())

    @property
    def queues(self):
        """How often `squeue` has been asked."""
        return len((self.folder / "queues").read_text().splitlines())


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """A stand-in for SLURM's programs; all of its jobs end with the test."""
    found = Slurm(tmp_path / "slurm")
    monkeypatch.setenv("PATH", str(found.folder), prepend=os.pathsep)
    yield found
    for group in found.folder.glob("job*/group"):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(int(group.read_text()), signal.SIGKILL)


def until(condition):
    """Wait until this is so; a test that hangs fails."""
    begin = time.monotonic()
    while not condition():
        assert time.monotonic() - begin < 15.0, "this takes too long"
        time.sleep(0.02)


def site(**settings):
    """What stands in jobqueue.yaml."""
    import dask_jobqueue  # noqa: F401  (of which this is the configuration; no worker may load it)

    return dask.config.set({"jobqueue.slurm": dask.config.get("jobqueue.slurm") | settings})


# ------------------------------------------------------------------------------------------ options


def script(options):
    """The lines of the job script for these options."""
    with job_cluster(options) as found:
        return found.job_script().strip().splitlines()


def test_the_job_script():
    lines = script(
        "jobs=3, cores=16, memory=32GB, walltime=1-02:00:00, queue=short,long, account=geo, "
        "interface=lo"
    )
    assert lines[0] == "#!/usr/bin/env bash"
    wanted = "-p short,long|-A geo|-n 1|--cpus-per-task=16|--mem=30G|-t 1-02:00:00"
    assert {f"#SBATCH {option}" for option in wanted.split("|")} <= {*lines}
    command = lines[-1]
    assert command.startswith(f"{sys.executable} -m distributed.cli.dask_worker tcp://127.0.0.1:")
    for part in (
        "--nthreads 1 ",
        "--memory-limit 1.86GiB ",
        "--nworkers 16 ",
        "--nanny ",
        "--interface lo",
    ):
        assert part in command
    assert "--nthreads 4 " in script("cores=16,memory=32GB,processes=4")[-1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (4, "slurm = 4 must be text. Give options such as 'jobs=10"),
        ("", "slurm: '' is not key=value with a key of jobs, replacements, wait, cores"),
        ("cores=4,memory=4GB,partition=a", "'partition=a' is not key=value with a key of .* queue"),
        ("cores=4", "slurm: memory of a job is not given"),
        ("cores=4x,memory=4GB", "slurm: cores = 4x is not an integer >= 1"),
        ("cores=4,memory=4GB,processes=8", "processes = 8 does not divide cores = 4"),
        ("cores=4,memory=four", "slurm: memory = four is not a size"),
        ("cores=4,memory=4GB,interface=ib7", "ib7"),
        ("cores=4,memory=4GB,replacements=-1", "replacements = -1 is not an integer >= 0"),
        ("cores=4,memory=4GB,wait=60", "wait = 60 is not hours:minutes:seconds"),
    ],
)
def test_bad_slurm_options(options, message):
    with pytest.raises(rs.ParameterError, match=message):
        job_cluster(options)


def test_missing_options_come_from_the_site():
    given = {
        "cores": 4,
        "memory": "8GB",
        "processes": 2,
        "queue": "long",
        "account": "geo",
        "walltime": "03:00:00",
        "worker-extra-args": ["--lifetime", "170m", "--lifetime-stagger", "5m"],
        "scheduler-options": {"host": "127.0.0.1"},
        "job-extra-directives": ["--gres=gpu:1"],
        "job-script-prologue": ["module load gcc"],
    }
    always = ["-A geo", "--gres=gpu:1"]
    others = "cores=3,memory=2GB,processes=3,queue=short,walltime=00:10:00"
    with site(**given):
        for options, directives, number in (
            ("jobs=2", "-p long|-t 03:00:00|--cpus-per-task=4|--mem=8G", 2),
            (others, "-p short|-t 00:10:00|--cpus-per-task=3|--mem=2G", 3),
        ):
            *header, command = script(options)
            wanted = {f"#SBATCH {option}" for option in [*directives.split("|"), *always]}
            assert wanted | {"module load gcc"} <= {*header}
            assert "dask_worker tcp://127.0.0.1:" in command
            assert f"--nworkers {number} " in command
            assert "--lifetime 170m --lifetime-stagger 5m" in command


def test_two_sweeps_at_a_time():
    """The dashboard's usual port is left alone, unless the site names one."""
    with job_cluster("cores=1,memory=1GB") as found:
        assert found.scheduler_spec["options"]["dashboard_address"] == ":0"
    own = {"scheduler-options": {"dashboard_address": "127.0.0.1:0"}}
    with site(**own), job_cluster("cores=1,memory=1GB") as found:
        assert found.scheduler_spec["options"]["dashboard_address"] == "127.0.0.1:0"


@pytest.mark.parametrize(
    ("options", "kept"),
    [
        ("jobs=3,cores=4,memory=4GB", (3, 30, 86400.0, 12)),
        ("jobs=3,cores=1,memory=1GB,replacements=0,wait=00:01:30", (3, 0, 90.0, 3)),
        ("cores=1,memory=1GB,replacements=7,wait=2-03:00:01", (1, 7, 183601.0, 1)),
    ],
)
def test_options_set_the_number_replacements_and_wait_of_jobs(slurm, options, kept):
    with slurm_module.slurm_cluster(options, "cpu") as backend:
        jobs = backend.jobs
        assert (jobs.number, jobs.replacements, jobs.wait, backend.thread_count) == kept
        until(lambda: slurm.submitted == jobs.number)
    states = [path.read_text() for path in slurm.folder.glob("job*/state")]
    assert states == ["CANCELLED\n"] * jobs.number
    client = types.SimpleNamespace(nthreads=lambda: {"tcp://a:1": 1, "tcp://b:1": 4})
    assert cluster.Cluster(client, "cpu").thread_count == 5


# -------------------------------------------------------------------------- what SLURM says of jobs


def test_answers_of_squeue(slurm, monkeypatch, tmp_path):
    slurm.answer("wait")
    for job in (1, 2):
        (slurm.folder / f"job{job}").mkdir()
    slurm.say(1, "PENDING")
    slurm.say(2, "RUNNING")
    (slurm.folder / "reason").write_text("Resources")
    assert squeue(["1", "2", "3"]) == {"1": "PENDING, Resources", "2": "RUNNING, Resources"}
    asked = (slurm.folder / "queues").read_text()
    assert asked == "--noheader --states=all --format=%i|%T|%r --jobs=1,2,3\n"
    (slurm.folder / "down").touch()
    assert squeue(["1"]) is None
    (slurm.folder / "squeue").write_text("#!/bin/sh\necho Invalid job id specified >&2; exit 1")
    assert squeue(["1"]) == {}
    (slurm.folder / "squeue").write_text("#!/bin/sh\nexec sleep 5")
    monkeypatch.setattr(slurm_module, "HANGS", 0.1)
    assert squeue(["1"]) is None
    monkeypatch.setenv("PATH", str(tmp_path))
    assert squeue(["1"]) is None


# ------------------------------------------------------------------------------------ jobs are lost


@pytest.fixture
def kept(slurm, monkeypatch):
    """Jobs with these options, which all have been submitted; SLURM is asked without a pause."""
    monkeypatch.setattr(slurm_module, "POLL", 0.0)

    @contextlib.contextmanager
    def jobs_of(options):
        with slurm_module.slurm_cluster(f"memory=1GB,{options}", "cpu") as backend:
            until(lambda: len(backend.jobs.cluster.workers) == backend.jobs.number)
            try:
                yield backend.jobs
            finally:
                for worker in workers:
                    leave(backend.jobs, worker)

    workers.clear()
    return jobs_of


workers: list = []  # workers of the jobs that are kept


def serve(jobs, job):
    """Let a job's worker come: a thread of this process."""

    async def come():
        return await Worker(jobs.cluster.scheduler_address, name=job, nthreads=1, dashboard=False)

    worker = jobs.cluster.sync(come)
    workers.append(worker)
    until(lambda: worker.address in jobs.cluster.scheduler.workers)
    jobs.maintain()
    return worker


def leave(jobs, worker):
    jobs.cluster.sync(worker.close)
    until(lambda: worker.address not in jobs.cluster.scheduler.workers)


def keep_until_submitted(slurm, jobs, number):
    """Look after the jobs once, and let Dask submit what that asks for."""
    jobs.maintain()
    cluster = jobs.cluster
    until(lambda: slurm.submitted == number and len(cluster.workers) == len(cluster.worker_spec))


def ids(jobs):
    return sorted(job.job_id for job in jobs.cluster.workers.values())


def test_jobs_are_replaced_until_that_is_used_up(slurm, kept, capfd):
    with kept("cores=2,jobs=2,replacements=2") as jobs:  # of several processes
        names = list(jobs.cluster.workers)
        worker = serve(jobs, f"{names[0]}-1")
        first, second = (jobs.cluster.workers[name].job_id for name in names)
        keep_until_submitted(slurm, jobs, 2)
        assert capfd.readouterr().err == ""
        slurm.say(first, "TIMEOUT")
        leave(jobs, worker)
        keep_until_submitted(slurm, jobs, 3)
        assert capfd.readouterr().err == (
            f"ratestate: SLURM jobs lost: job {first} (TIMEOUT). Replacements submitted: 1. "
            f"At most 1 more are allowed.\n"
        )
        slurm.say(second, "CANCELLED")
        slurm.forget(3)
        keep_until_submitted(slurm, jobs, 4)
        said = capfd.readouterr().err
        assert f"job {second} (CANCELLED)" in said
        assert "job 3 (COMPLETED)" in said
        assert "Replacements submitted: 1. At most 0 more are allowed." in said
        keep_until_submitted(slurm, jobs, 4)
        assert ids(jobs) == ["4"]
        slurm.say(4, "NODE_FAIL")
        (slurm.folder / "reason").write_text("Why")
        message = (
            r"^No SLURM job is left, and all 2 replacements are used\. The last was "
            r"job 4 \(NODE_FAIL, Why\)\. .* with a longer walltime or more replacements=N\.$"
        )
        with pytest.raises(rs.SolverError, match=message):
            jobs.maintain()
        assert slurm.submitted == 4


def test_the_cluster_closes_while_a_lost_job_is_remembered(slurm, kept):
    """As by the traceback of the error, which Dask's own check of its jobs must not replace."""
    held = []
    with kept("cores=1,jobs=1,replacements=0") as jobs:
        held += jobs.cluster.workers.values()
        slurm.say(held[0].job_id, "TIMEOUT")
        with pytest.raises(rs.SolverError, match=r"were lost before a worker came"):
            jobs.maintain()


@pytest.mark.parametrize("way", ["fail", "sbatch: error: QOSMaxSubmitJobPerUserLimit"])
def test_jobs_that_end_before_any_worker_comes_are_not_replaced(slurm, kept, way):
    slurm.answer(way)
    with kept("cores=1,jobs=2") as jobs:
        why = r"job [12] \(FAILED\)" if way == "fail" else rf"one refused \({way}\)"
        message = rf"before a worker came\. The last was {why}\. Its log .* must reach tcp://"
        with pytest.raises(rs.SolverError, match=message):
            jobs.maintain()
        assert slurm.submitted == 2


def test_jobs_that_never_start_end_the_sweep_after_the_wait(slurm, kept, monkeypatch):
    (slurm.folder / "reason").write_text("PartitionDown")
    with kept("cores=1,jobs=2,wait=00:01:00") as jobs, monkeypatch.context() as patch:
        begin = jobs.last_worker
        patch.setattr(time, "monotonic", lambda: begin + 59.0)
        jobs.maintain()
        patch.setattr(time, "monotonic", lambda: begin + 61.0)
        message = (
            r"^No worker has come for 60 s: job \d \(PENDING, PartitionDown\), job \d \(PENDING, "
            r"PartitionDown\)\. Ask for less in a job, .* Run the same sweep again to resume\.$"
        )
        with pytest.raises(rs.SolverError, match=message):
            jobs.maintain()
        serve(jobs, next(iter(jobs.cluster.workers)))
        patch.setattr(time, "monotonic", lambda: begin + 150.0)
        jobs.maintain()  # there is one


def test_slurm_is_asked_at_intervals_and_may_not_answer(slurm, kept, monkeypatch):
    with kept("cores=1") as jobs, monkeypatch.context() as patch:
        (slurm.folder / "down").touch()
        slurm.forget(1)
        keep_until_submitted(slurm, jobs, 1)
        patch.setattr(slurm_module, "POLL", 15.0)
        now, before = jobs.last_query, slurm.queues
        for later, queues in {14.0: 0, 16.0: 1, 30.0: 1, 32.0: 2}.items():
            patch.setattr(time, "monotonic", lambda later=later: now + later)
            jobs.maintain()
            assert slurm.queues == before + queues


# ------------------------------------------------------------------------------ with Dask's workers


def test_a_sweep_outlives_its_jobs(slurm, monkeypatch, capfd, tmp_path):
    def call(slider, V_lp):
        return Held(**vars(stability_call(slider, V_lp)))

    monkeypatch.setitem(calls.FUNCTIONS, "stability", (rs.stability, call))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent), prepend=os.pathsep)
    monkeypatch.chdir(tmp_path)
    slurm.answer("run")
    cancelled, go_on, maintain = [], tmp_path / "go on", Jobs.maintain

    def cancel_one(jobs):
        """Cancel a job when two are at work."""
        maintain(jobs)
        there = list(jobs.cluster.scheduler.workers.values())
        if not cancelled and sum(bool(worker.processing) for worker in there) == 2:
            cancelled.append(ids(jobs)[0])
            slurm.end(cancelled[0])
            go_on.touch()

    monkeypatch.setattr(slurm_module, "POLL", 0.2)
    monkeypatch.setattr(cluster, "COUNT_INTERVAL", 0.2)
    monkeypatch.setattr(Jobs, "maintain", cancel_one)
    arguments = {"V_lp": 1e-2, "progress": False}
    slurm_options = "jobs=2,cores=1,memory=1GB,interface=lo"
    with site(**{"job-script-prologue": [f"export HELD_UNTIL='{go_on}'"]}):
        found = rs.sweep("stability", SLIDER, chunk=3, slurm=slurm_options, **arguments)
    said = [line for line in capfd.readouterr().err.splitlines() if "lost" in line]
    lost = f"job {cancelled[0]} (CANCELLED)"
    assert said == [
        f"ratestate: SLURM jobs lost: {lost}. Replacements submitted: 1. "
        f"At most 19 more are allowed."
    ]
    xarray.testing.assert_identical(found, rs.sweep("stability", SLIDER, **arguments))
