"""A SLURM cluster of one node, this machine, set up from nothing in a temporary folder.

Debian's ``munge`` and ``slurm-wlm`` have the programs.  The daemons listen on ports of their own,
as the user that starts them, and know no cgroups, so that a container can run them; whatever SLURM
the machine may have besides stays untouched.
"""

import contextlib
import getpass
import os
import secrets
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scancel", "sinfo", "squeue")
# Seconds for the node to be ready; from SIGTERM to SIGKILL at a job's end.
PATIENCE, KILL_WAIT = 30.0, 5
SLURM_CONF = """
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
MailProg=/bin/true
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerParameters=batch_sched_delay=1,sched_interval=2,bf_interval=2
KillWait={kill_wait}
ReturnToService=2
SlurmdParameters=config_overrides
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=short Nodes=ALL Default=YES MaxTime=1:00:00 State=UP
PartitionName=closed Nodes=ALL MaxTime=1:00:00 State=DOWN
"""
CGROUP_CONF = "IgnoreSystemd=yes\n"


def missing():
    """Names of the programs that this machine lacks."""
    return [name for name in PROGRAMS if not shutil.which(name, path=_path())]


def _path():
    return os.pathsep.join([os.environ["PATH"], "/usr/sbin"])  # where Debian has daemons


@contextlib.contextmanager
def one_node(cpus=4, memory=8000):
    """Folder of a SLURM with one node that has so many CPUs and MB; it goes when this ends.

    While it is there ``SLURM_CONF`` in this process's environment has programs use it.  Of its two
    partitions, ``short`` runs jobs, and ``closed`` lets them wait.
    """
    before = os.environ.get("SLURM_CONF")
    with contextlib.ExitStack() as until_done:
        folder = Path(until_done.enter_context(tempfile.TemporaryDirectory(prefix="one-node-")))
        folder.chmod(0o755)  # munged wants to see what may reach its socket
        conf = _written(folder, cpus, memory)
        os.environ["SLURM_CONF"] = str(conf)
        try:
            for command in _daemons(folder, conf):
                until_done.enter_context(_running(command, folder))
            _wait_until_idle(folder)
            try:
                yield folder
            finally:
                _cancel_all()
        finally:
            if before is None:
                del os.environ["SLURM_CONF"]
            else:
                os.environ["SLURM_CONF"] = before


def _written(folder, cpus, memory):
    """Write what the daemons read; the path of slurm.conf."""
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.touch(0o600)
    key.write_bytes(secrets.token_bytes(1024))
    (folder / "cgroup.conf").write_text(CGROUP_CONF)
    conf = folder / "slurm.conf"
    conf.write_text(
        SLURM_CONF.format(
            folder=folder,
            host=socket.gethostname().split(".")[0],
            user=getpass.getuser(),
            ports=_free_ports(2),
            cpus=cpus,
            memory=memory,
            kill_wait=KILL_WAIT,
        )
    )
    return conf


def _free_ports(number):
    """So many ports that nobody listens on."""
    with contextlib.ExitStack() as until_known:
        sockets = [until_known.enter_context(socket.socket()) for _ in range(number)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def _daemons(folder, conf):
    """Commands of the daemons, in the foreground, in the order of their start."""
    own = ("key", "socket", "pid", "log", "seed")
    options = {"key": "key-file", "pid": "pid-file", "log": "log-file", "seed": "seed-file"}
    files = [f"--{options.get(name, name)}={folder}/munge.{name}" for name in own]
    # --force: root may run it, too
    yield ["munged", "--foreground", "--force", "--num-threads=2", *files]
    yield ["slurmctld", "-D", "-c", "-f", str(conf)]
    yield ["slurmd", "-D", "-c", "-f", str(conf)]


@contextlib.contextmanager
def _running(command, folder):
    """A daemon, ended with this."""
    with (folder / f"{command[0]}.out").open("w") as out:
        daemon = subprocess.Popen(
            command,
            stdout=out,
            stderr=out,
            env=os.environ | {"PATH": _path()},
            start_new_session=True,  # Ctrl-C leaves it there to cancel the jobs
        )
    try:
        time.sleep(0.5)  # munged is slow to open its socket
        yield
    finally:
        daemon.terminate()
        try:
            daemon.wait(10.0)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()


def _cancel_all():
    """Cancel all jobs, and wait until their processes are gone."""
    subprocess.run(["scancel", f"--user={getpass.getuser()}"], check=False)
    begin = time.monotonic()
    while time.monotonic() - begin < PATIENCE:
        if not subprocess.run(["squeue", "--noheader"], capture_output=True, check=False).stdout:
            return
        time.sleep(0.5)


def _wait_until_idle(folder):
    """Return when the node takes jobs; RuntimeError with the daemons' words if it does not."""
    begin = time.monotonic()
    while time.monotonic() - begin < PATIENCE:
        command = ["sinfo", "--noheader", "--partition=short", "--format=%T"]
        state = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
        if state == "idle":
            return
        time.sleep(0.5)
    logs = "\n".join(f"{path.name}:\n{path.read_text()}" for path in sorted(folder.glob("*.out")))
    raise RuntimeError(f"SLURM's node is {state or 'nowhere'} after {PATIENCE} s:\n{logs}")
