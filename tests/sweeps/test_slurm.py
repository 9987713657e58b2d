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
from distributed import Client, Worker
from misbehaving import Held

import ratestate as rs
from ratestate.dynamics.steady_sliding import stability_call
from ratestate.sweeps import backends, calls, cluster, cluster_work
from ratestate.sweeps.jobs import Jobs, State
from ratestate.sweeps.slurm import SLURM, squeue

SLIDER = rs.SpringSlider(
    a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=rs.logspace("M", 1e2, 1e5, 90)
)
# Stand-ins for SLURM's programs.  $0's folder has, for each job, a folder with its state; what
# `sbatch` does with a job stands in `answer`: run, wait, fail, or what it says when it refuses.
SBATCH = """\
cd "$(dirname "$0")" && echo "$*" >> asked
[ "$1" != --test-only ] || exec cat test-only
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
        for name, text in {"test-only": "", "asked": "", "queues": "", "reason": "None"}.items():
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
        lines = (self.folder / "asked").read_text().splitlines()
        return sum(not line.startswith("--test-only") for line in lines)

    @property
    def queues(self):
        """How often `squeue` has been asked."""
        return len((self.folder / "queues").read_text().splitlines())


@pytest.fixture(autouse=True)
def in_time():
    """Let a test that hangs fail."""

    def late(*_):
        raise TimeoutError("this takes too long")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(150)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


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
    with backends.job_cluster(options, start=False) as found:
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


def test_the_job_script_has_what_the_site_needs():
    own = {"job-extra-directives": ["--gres=gpu:1"], "job-script-prologue": ["module load gcc"]}
    with site(**own):
        lines = script("cores=1,memory=4GB")
    assert "#SBATCH --gres=gpu:1" in lines
    assert "module load gcc" in lines
    assert "--nworkers" not in lines[-1]


def test_another_batch_system_is_another_table():
    pbs = SLURM._replace(name="pbs", label="PBS", dask_class="PBSCluster", submit="qsub")
    options = "jobs=2,cores=4,memory=4GB,queue=short"
    with backends.job_cluster(options, start=False, system=pbs) as found:
        assert "#PBS -q short" in found.job_script()
        assert found.jobs.thread_count == 8
    with pytest.raises(rs.ParameterError, match="pbs: memory of a job must be given"):
        backends.job_cluster("cores=4", system=pbs)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (4, "slurm = 4 is not a text; for example jobs=10"),
        ("", "slurm: '' is not key=value with a key of jobs, replacements, wait, cores"),
        ("cores", "slurm: 'cores' is not key=value"),
        ("cores=4,memory=4GB,partition=a", "'partition=a' is not key=value with a key of .* queue"),
        ("cores=4", "slurm: memory of a job must be given; for example jobs=10,cores=16"),
        ("jobs=4", "slurm: cores and memory of a job must be given"),
        ("cores=4x,memory=4GB", "slurm: cores = 4x must be an integer >= 1"),
        ("cores=4,memory=4GB,jobs=0", "slurm: jobs = 0 must be an integer >= 1"),
        ("cores=4,memory=4GB,processes=8", "processes = 8 must divide cores = 4"),
        ("cores=4,memory=four", "memory = four is no size, such as 32GB"),
        ("cores=4,memory=1GB", "memory = 1GB gives each of 4 processes 250 MB; each needs 500"),
        ("cores=4,memory=4GB,walltime=2h", "walltime = 2h is not hours:minutes:seconds"),
        ("cores=4,memory=4GB,interface=ib7", "ib7"),
        ("cores=4,memory=4GB,replacements=-1", "replacements = -1 must be an integer >= 0"),
        ("cores=4,memory=4GB,wait=60", "wait = 60 is not hours:minutes:seconds"),
    ],
)
def test_bad_slurm_options(options, message):
    with pytest.raises(rs.ParameterError, match=message):
        backends.job_cluster(options)


def test_what_is_not_given_is_the_site_s():
    given = {
        "cores": 4,
        "memory": "8GB",
        "processes": 2,
        "queue": "long",
        "account": "geo",
        "walltime": "03:00:00",
        "worker-extra-args": ["--lifetime", "170m", "--lifetime-stagger", "5m"],
        "scheduler-options": {"host": "127.0.0.1"},
    }
    with site(**given):
        *header, command = script("jobs=2")
        assert {
            f"#SBATCH {option}"
            for option in ("-p long", "-A geo", "-t 03:00:00", "--cpus-per-task=4", "--mem=8G")
        } <= {*header}
        for part in (
            "dask_worker tcp://127.0.0.1:",
            "--nthreads 2 ",
            "--nworkers 2 ",
            "--lifetime 170m --lifetime-stagger 5m",
        ):
            assert part in command
        *header, command = script("cores=3,memory=2GB,processes=3,queue=short,walltime=00:10:00")
        assert {
            f"#SBATCH {option}"
            for option in ("-p short", "-A geo", "-t 00:10:00", "--cpus-per-task=3", "--mem=2G")
        } <= {*header}
        assert "--nworkers 3 " in command


def test_two_sweeps_at_a_time():
    """The dashboard's usual port is left alone, unless the site names one."""
    with backends.job_cluster("cores=1,memory=1GB", start=False) as found:
        assert found.scheduler_spec["options"]["dashboard_address"] == ":0"
    with (
        site(**{"scheduler-options": {"dashboard_address": "127.0.0.1:0"}}),
        backends.job_cluster("cores=1,memory=1GB", start=False) as found,
    ):
        assert found.scheduler_spec["options"]["dashboard_address"] == "127.0.0.1:0"


@pytest.mark.parametrize(
    ("options", "kept"),
    [
        ("cores=1,memory=1GB", (1, 10, 86400.0)),
        ("jobs=3,cores=2,memory=1GB", (3, 30, 86400.0)),
        ("jobs=3,cores=1,memory=1GB,replacements=0,wait=00:01:30", (3, 0, 90.0)),
        ("cores=1,memory=1GB,replacements=7,wait=2-03:00:01", (1, 7, 183601.0)),
    ],
)
def test_how_jobs_are_kept(options, kept):
    with backends.job_cluster(options, start=False) as found:
        jobs = found.jobs
        assert (jobs.number, jobs.replacements, jobs.wait) == kept
        assert jobs.thread_count == jobs.number * int(options.partition("cores=")[2][0])
        client = types.SimpleNamespace(cluster=found, nthreads=lambda: {"tcp://a:1": 1})
        assert cluster.Cluster(client, "cpu").thread_count == jobs.thread_count
    client = types.SimpleNamespace(cluster=None, nthreads=lambda: {"tcp://a:1": 1, "tcp://b:1": 4})
    assert cluster.Cluster(client, "cpu").thread_count == 5


def test_a_client_or_slurm():
    with pytest.raises(rs.ParameterError, match="client and slurm both say"):
        rs.sweep(
            "limit_cycle",
            SLIDER,
            V_lp=1e-2,
            client=types.SimpleNamespace(nthreads=None),
            slurm="cores=1,memory=1GB",
        )


def test_jobs_are_submitted(slurm):
    with backends.job_cluster("jobs=2,cores=1,memory=1GB"):
        until(lambda: slurm.submitted == 2)
    assert (slurm.folder / "asked").read_text().startswith("--test-only")
    states = [path.read_text() for path in slurm.folder.glob("job*/state")]
    assert states == ["CANCELLED\n"] * 2


def test_a_job_that_slurm_refuses(slurm):
    refusal = "cd ${0%/*}; echo $* >> asked; echo sbatch: error: no partition nosuch >&2; exit 1"
    (slurm.folder / "sbatch").write_text(f"#!/bin/sh\n{refusal}")
    with pytest.raises(rs.ParameterError, match="error: no partition nosuch; SLURM refuses this"):
        backends.job_cluster("jobs=2,cores=1,memory=1GB,queue=nosuch")
    assert len((slurm.folder / "asked").read_text().splitlines()) == 1


def test_a_machine_without_slurm(monkeypatch):
    monkeypatch.setenv("PATH", "")
    with pytest.raises(rs.ParameterError, match="no sbatch; run the sweep where jobs"):
        backends.job_cluster("cores=1,memory=1GB")


# -------------------------------------------------------------------------- what SLURM says of jobs


def test_what_squeue_says(slurm, monkeypatch, tmp_path):
    slurm.answer("wait")
    for job in (1, 2):
        (slurm.folder / f"job{job}").mkdir()
    slurm.say(1, "PENDING")
    slurm.say(2, "RUNNING")
    (slurm.folder / "reason").write_text("Resources")
    assert squeue(["1", "2", "3"]) == {
        "1": State("PENDING", "Resources"),
        "2": State("RUNNING", "Resources"),
    }
    assert str(State("PENDING", "Resources")) == "PENDING, Resources"
    assert str(State("CANCELLED", "None")) == "CANCELLED"
    asked = (slurm.folder / "queues").read_text()
    assert asked == "--noheader --states=all --format=%i|%T|%r --jobs=1,2,3\n"
    (slurm.folder / "down").touch()
    assert squeue(["1"]) is None
    (slurm.folder / "squeue").write_text("#!/bin/sh\necho Invalid job id specified >&2; exit 1")
    assert squeue(["1"]) == {}
    (slurm.folder / "squeue").write_text("#!/bin/sh\nexec sleep 5")
    monkeypatch.setattr("ratestate.sweeps.slurm.HANGS", 0.1)
    assert squeue(["1"]) is None
    monkeypatch.setenv("PATH", str(tmp_path))
    assert squeue(["1"]) is None


def test_whether_a_job_has_ended(monkeypatch):
    now = time.monotonic()
    jobs = Jobs(SLURM, None, 1, 1, 1.0)
    jobs.job_of = {"tcp://a:1": "17"}
    assert jobs.has_ended("tcp://b:1", now) is False  # of no job that is known
    assert jobs.has_ended("tcp://a:1", now) is None
    assert jobs.urgent
    assert jobs.has_ended("tcp://a:1", now - 59.0) is None
    assert jobs.has_ended("tcp://a:1", now - 61.0) is False
    jobs.states["17"], jobs.last_answer = State("RUNNING", ""), now - 1.0
    assert jobs.has_ended("tcp://a:1", now) is None
    assert jobs.has_ended("tcp://a:1", now - 2.0) is False
    for state in ("CANCELLED", "TIMEOUT", "COMPLETED", "FAILED", "NODE_FAIL", "PREEMPTED"):
        jobs.states["17"] = State(state, "")
        assert jobs.has_ended("tcp://a:1", now) is True
    jobs.states["17"] = State("COMPLETING", "")
    assert jobs.has_ended("tcp://a:1", now) is None


# ------------------------------------------------------------------------------------ jobs are lost


@pytest.fixture
def kept(slurm, monkeypatch):
    """A cluster of these jobs, which all have been submitted; SLURM is asked without a pause."""
    monkeypatch.setattr("ratestate.sweeps.jobs.POLL", 0.0)

    @contextlib.contextmanager
    def cluster_of(options):
        with backends.job_cluster(f"memory=1GB,{options}") as found:
            until(lambda: len(found.workers) == found.jobs.number)
            try:
                yield found
            finally:
                for worker in workers:
                    leave(found, worker)

    workers.clear()

    return cluster_of


workers: list = []  # workers of the cluster that is kept


def serve(cluster, job):
    """Let a job's worker come: a thread of this process."""

    async def come():
        return await Worker(cluster.scheduler_address, name=job, nthreads=1, dashboard=False)

    worker = cluster.sync(come)
    workers.append(worker)
    until(lambda: worker.address in cluster.scheduler.workers)
    cluster.jobs.maintain()
    return worker


def leave(cluster, worker):
    cluster.sync(worker.close)
    until(lambda: worker.address not in cluster.scheduler.workers)


def keep_until_submitted(slurm, cluster, number):
    """Look after the jobs once, and let Dask submit what that asks for."""
    cluster.jobs.maintain()
    until(lambda: slurm.submitted == number and len(cluster.workers) == len(cluster.worker_spec))


def test_jobs_are_replaced_until_that_is_used_up(slurm, kept, capfd):
    with kept("cores=1,jobs=2,replacements=2") as cluster:
        names = list(cluster.workers)
        worker = serve(cluster, names[0])
        first, second = (cluster.workers[name].job_id for name in names)
        keep_until_submitted(slurm, cluster, 2)
        assert capfd.readouterr().err == ""
        slurm.say(first, "TIMEOUT")
        leave(cluster, worker)
        keep_until_submitted(slurm, cluster, 3)
        assert capfd.readouterr().err == (
            f"ratestate: SLURM jobs lost: job {first} (TIMEOUT); 1 submitted instead; "
            f"at most 1 more will be\n"
        )
        slurm.say(second, "CANCELLED")
        slurm.say(3, "CANCELLED")
        (slurm.folder / "reason").write_text("Why")
        keep_until_submitted(slurm, cluster, 4)
        assert "1 submitted instead; at most 0 more will be" in capfd.readouterr().err
        keep_until_submitted(slurm, cluster, 4)
        assert [job.job_id for job in cluster.workers.values()] == ["4"]
        serve(cluster, next(iter(cluster.workers)))
        slurm.say(4, "NODE_FAIL")
        message = (
            r"^no SLURM job is left, the last was job 4 \(NODE_FAIL, Why\), and all 2 replacements "
            r"are used up; what is stored is whole: run the same sweep again to go on, with a "
            r"longer walltime or more replacements=N$"
        )
        with pytest.raises(rs.SolverError, match=message):
            cluster.jobs.maintain()
        assert slurm.submitted == 4


def test_jobs_of_several_processes_are_replaced(slurm, kept):
    """Dask's own `adapt` does not see that they are gone."""
    with kept("cores=2,processes=2") as cluster:
        worker = serve(cluster, f"{next(iter(cluster.workers))}-1")
        assert list(cluster.jobs.job_of.values()) == ["1"]
        slurm.say(1, "CANCELLED")
        leave(cluster, worker)
        keep_until_submitted(slurm, cluster, 2)
        assert [job.job_id for job in cluster.workers.values()] == ["2"]


@pytest.mark.parametrize("way", ["fail", "sbatch: error: QOSMaxSubmitJobPerUserLimit"])
def test_jobs_that_end_before_a_worker_comes(slurm, kept, way):
    """Three in a row are enough, however many might be submitted."""
    slurm.answer(way)
    with kept("cores=1,jobs=2") as cluster:
        keep_until_submitted(slurm, cluster, 4)
        why = r"job [34] \(FAILED\)" if way == "fail" else rf"one refused \({way}\)"
        message = (
            rf"^4 SLURM jobs in a row were lost before a worker came, at last {why}; its log .* "
            rf"must reach tcp://.*run the same sweep again to go on$"
        )
        with pytest.raises(rs.SolverError, match=message):
            cluster.jobs.maintain()
        assert slurm.submitted == 4
        # such as are refused cost nothing: the two jobs, and 20 replacements, are still to come
        assert cluster.jobs.replacements_left == (18 if way == "fail" else 22)


def test_a_worker_that_comes_gives_new_hope(slurm, kept):
    with kept("cores=1,jobs=2") as cluster:
        slurm.answer("fail")
        slurm.say(1, "FAILED")
        keep_until_submitted(slurm, cluster, 3)  # it fails at once
        keep_until_submitted(slurm, cluster, 4)
        keep_until_submitted(slurm, cluster, 4)  # no more
        assert [job.job_id for job in cluster.workers.values()] == ["2"]
        slurm.answer("wait")
        serve(cluster, next(iter(cluster.workers)))
        keep_until_submitted(slurm, cluster, 5)
        assert sorted(job.job_id for job in cluster.workers.values()) == ["2", "5"]


def test_a_queue_that_starts_nothing(slurm, kept, monkeypatch):
    (slurm.folder / "reason").write_text("PartitionDown")
    with kept("cores=1,jobs=2,wait=00:01:00") as cluster:
        begin = cluster.jobs.last_worker
        monkeypatch.setattr(time, "monotonic", lambda: begin + 59.0)
        cluster.jobs.maintain()
        monkeypatch.setattr(time, "monotonic", lambda: begin + 61.0)
        message = (
            r"^no worker for 60 s: job \d \(PENDING, PartitionDown\), job \d \(PENDING, PartitionDo"
            r"wn\); ask for less in a job, .* run the same sweep again to go on$"
        )
        with pytest.raises(rs.SolverError, match=message):
            cluster.jobs.maintain()
        worker = serve(cluster, next(iter(cluster.workers)))
        monkeypatch.setattr(time, "monotonic", lambda: begin + 150.0)
        cluster.jobs.maintain()  # there is one
        leave(cluster, worker)
        monkeypatch.setattr(time, "monotonic", lambda: begin + 209.0)
        cluster.jobs.maintain()
        monkeypatch.setattr(time, "monotonic", lambda: begin + 211.0)
        with pytest.raises(rs.SolverError, match="no worker for 60 s"):
            cluster.jobs.maintain()


def test_slurm_forgets_what_has_ended_and_may_be_away(slurm, kept):
    with kept("cores=1") as cluster:
        slurm.forget(1)
        keep_until_submitted(slurm, cluster, 1)  # it has never been listed: it may yet be
        slurm.say(1, "RUNNING")
        keep_until_submitted(slurm, cluster, 1)
        slurm.forget(1)
        (slurm.folder / "down").touch()
        keep_until_submitted(slurm, cluster, 1)
        (slurm.folder / "down").unlink()
        keep_until_submitted(slurm, cluster, 2)


def test_slurm_is_not_asked_all_the_time(slurm, kept, monkeypatch):
    with kept("cores=1") as cluster:
        monkeypatch.setattr("ratestate.sweeps.jobs.POLL", 15.0)
        jobs, now = cluster.jobs, time.monotonic()
        jobs.last_query = now
        for later, queues in {14.0: 0, 16.0: 1, 30.0: 1, 32.0: 2}.items():
            monkeypatch.setattr(time, "monotonic", lambda later=later: now + later)
            jobs.maintain()
            assert slurm.queues == queues
        jobs.urgent = True
        for later, queues in {32.5: 2, 33.5: 3, 40.0: 3}.items():
            monkeypatch.setattr(time, "monotonic", lambda later=later: now + later)
            jobs.maintain()
            assert slurm.queues == queues


def test_a_job_outlives_its_worker(slurm, kept):
    """Dask would cancel it, were its worker not back soon; the nanny may take longer."""
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "0.1s"}),
        kept("cores=1") as cluster,
    ):
        leave(cluster, serve(cluster, next(iter(cluster.workers))))
        time.sleep(0.5)
        keep_until_submitted(slurm, cluster, 1)
        assert [job.job_id for job in cluster.workers.values()] == ["1"]
        assert (slurm.folder / "job1" / "state").read_text().strip() == "PENDING"


# ------------------------------------------------------------------------------ with Dask's workers


def test_a_sweep_outlives_its_jobs(slurm, monkeypatch, capfd, tmp_path):
    """A worker's death makes its chunks suspect, and its job's end does not."""

    def call(slider, V_lp):
        return Held(**vars(stability_call(slider, V_lp)))

    monkeypatch.setitem(calls.FUNCTIONS, "stability", (rs.stability, call))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent), prepend=os.pathsep)
    monkeypatch.chdir(tmp_path)
    slurm.answer("run")
    both = tmp_path / "both"
    events, seen, maintain, lost_tasks = [], set(), Jobs.maintain, cluster_work.Work.lost_tasks

    def meanwhile(jobs):
        """Kill a worker when two are at work; cancel the other's job when they are so again."""
        maintain(jobs)
        there = dict(list(jobs.cluster.scheduler.workers.items()))
        at_work = sum(bool(worker.processing) for worker in there.values())
        known = there.keys() <= jobs.job_of.keys()  # (one that has just come is not yet)
        if at_work == 2 and not events:
            with Client(jobs.cluster.scheduler_address, set_as_default=False) as client:
                events.append(min(there))
                os.kill(client.run(os.getpid)[events[0]], signal.SIGKILL)
        elif at_work == 2 and known and len(events) == 1 and seen and events[0] not in there:
            (job,) = {jobs.job_of[address] for address in there} - {jobs.job_of[events[0]]}
            events.append(job)
            slurm.end(job)
            both.touch()

    def watched(work):
        known = lost_tasks(work)
        seen.update((len(events), job_has_ended) for _, job_has_ended in known)
        return known

    for name in ("jobs.POLL", "jobs.SOON", "cluster_work.LOOK"):
        monkeypatch.setattr(f"ratestate.sweeps.{name}", 0.2)
    monkeypatch.setattr(Jobs, "maintain", meanwhile)
    monkeypatch.setattr(cluster_work.Work, "lost_tasks", watched)
    arguments = {"V_lp": 1e-2, "progress": False}
    slurm_options = "jobs=2,cores=1,memory=1GB,interface=lo"
    with site(**{"job-script-prologue": [f"export HELD_UNTIL={both}"]}):
        found = rs.sweep("stability", SLIDER, chunk=3, slurm=slurm_options, **arguments)
    assert seen == {(1, False), (2, True)}
    said = [line for line in capfd.readouterr().err.splitlines() if "lost" in line]
    lost = f"job {events[1]} (CANCELLED)"
    assert said == [
        f"ratestate: SLURM jobs lost: {lost}; 1 submitted instead; at most 19 more will be"
    ]
    assert slurm.submitted == 3
    xarray.testing.assert_identical(found, rs.sweep("stability", SLIDER, **arguments))
