"""Resources of this process: cores, memory and child processes.

A process in a container or in a scheduler's job sees all cores and all memory of its machine, but
its control group (cgroup) limits it.  Version 1 of cgroups has a tree of folders for each resource;
version 2 has one tree.

A child process computes one item after the other, for records and files.  It is a new
interpreter that imports only the function's module (0.3 s).  It is not a fork, because other
threads may run.  It does not import ``__main__``, so scripts need no guard.  It reads pickled items
from its stdin, and returns a pickled result or exception for each.
"""

import contextlib
import functools
import importlib
import math
import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from .errors import ParameterError

is_child = False  # whether this process is such a child
CGROUP_FILE, CGROUP_ROOT = Path("/proc/self/cgroup"), Path("/sys/fs/cgroup")


def cores():
    """Return the number of cores that this process may use, an int >= 1.

    It is the smallest of three limits: the cores that the process may run on, the CPU quotas of its
    control groups (rounded up), and NUMBA_NUM_THREADS in the environment.
    """
    processors = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else ()
    limits = [len(processors) or os.cpu_count() or 1, *_cpu_quotas()]
    wanted = os.environ.get("NUMBA_NUM_THREADS", "")
    if wanted.isdecimal() and int(wanted) > 0:
        limits.append(int(wanted))
    return min(limits)


@functools.cache
def _cpu_quotas():
    """Return the CPU quotas of this process's control groups, in cores, rounded up (list)."""
    quotas = []
    for folder in _cgroup_folders("cpu"):
        # the quota and its period are in one file in version 2, and in two files in version 1
        share = [
            number
            for name in ("cpu.max", "cpu.cfs_quota_us", "cpu.cfs_period_us")
            for number in _read_limits(folder / name)
        ]
        if len(share) == 2 and 0.0 < share[0] < math.inf:  # -1 and "max" mean no quota
            quotas.append(math.ceil(share[0] / share[1]))
    return quotas


#: bytes that any process has: for smaller sizes, `check_fits` does not query the system
ALWAYS_AVAILABLE = 1e3


def memory():
    """Return the bytes of memory that this process may have; inf if they are unknown."""
    limits = [math.inf]
    if hasattr(os, "sysconf"):
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for folder in _cgroup_folders("memory"):
        for name in ("memory.max", "memory.limit_in_bytes"):
            limits += _read_limits(folder / name)
    return min(limits)


def check_fits(size, subject, remedy):
    """Raise ParameterError if an array of `size` bytes exceeds the memory of this process.

    subject : str, subject of the message, in the plural
    remedy : str, how to need less memory
    """
    if size > ALWAYS_AVAILABLE and size > (free := memory()):
        raise ParameterError(
            f"{subject} need {size / 1e9:,.3g} GB of memory, but the limit is {free / 1e9:,.3g} GB",
            remedy,
        )


def _cgroup_folders(resource):
    """Return the folders that limit this process: its control group and all parents (list)."""
    try:
        lines = CGROUP_FILE.read_text().splitlines()
    except OSError:  # not Linux
        return []
    folders = []
    for line in lines:
        _, names, path = line.split(":", 2)
        if not names or resource in names.split(","):
            top = CGROUP_ROOT / names
            inside = top / path.lstrip("/")
            folders += [f for f in (inside, *inside.parents) if f.is_relative_to(top)]
    return folders


def _read_limits(file):
    """Return the numbers in a file of limits; [] if the file does not exist."""
    try:
        return [math.inf if word == "max" else float(word) for word in file.read_text().split()]
    except (OSError, ValueError):
        return []


#: longest time that a child takes to end after it has closed its pipe [s]
ENDING = 1.0


class ChildDied(Exception):
    """Raised if the child has ended or could not be started."""


class Child:
    """A child process that computes a function; a context manager that ends the process.

    function : defined in a module, not in ``__main__``; its items and results can be pickled
    stderr : passed on to `subprocess.Popen`

    `ready` is True once the child has imported the function.
    """

    def __init__(self, function, stderr=None):
        self.name, self.stderr = (function.__module__, function.__qualname__), stderr
        self.process: Any = None
        self.ready = False

    def __enter__(self):
        with contextlib.suppress(OSError):  # `call` reports a process that did not start
            folders = os.pathsep.join(folder or str(Path.cwd()) for folder in sys.path)
            variables = {"PYTHONPATH": folders, "OPENBLAS_NUM_THREADS": "1"}
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {__name__} import serve; serve()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.stderr,
                env=os.environ | variables,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
            self._send(pickle.dumps(self.name))
        return self

    def __exit__(self, *_):
        self.kill()
        if self.process is not None:
            with contextlib.suppress(OSError):
                self.process.communicate()

    def kill(self):
        """Kill the process."""
        if self.process is not None:
            self.process.kill()

    def call(self, item):
        """Return the function's result for an item; raise its exception, or ChildDied."""
        if self.process is None:
            raise ChildDied
        task = pickle.dumps(item, 5)
        try:
            self.ready = self.ready or pickle.load(self.process.stdout)
            self._send(task)
            result, error = pickle.load(self.process.stdout)
        except Exception as failure:  # it died, or its answer cannot be unpickled
            if isinstance(failure, EOFError | BrokenPipeError):  # the process ends by itself
                with contextlib.suppress(subprocess.TimeoutExpired):
                    self.process.wait(ENDING)
            self.kill()
            raise ChildDied from None
        if error is not None:
            raise error
        return result

    def ending(self):
        """Wait until a process that died has ended; return its signal or exit code as text."""
        if self.process is None:
            return "it did not start"
        code = self.process.wait()
        with contextlib.suppress(ValueError):
            return signal.Signals(-code).name
        return f"exit code {code}"

    def _send(self, task):
        self.process.stdin.write(task)
        self.process.stdin.flush()


def serve():
    """Run the main loop of a child: compute items from stdin until stdin ends."""
    global is_child
    is_child = True
    for number in (signal.SIGINT, signal.SIGTERM):  # the parent also gets them and kills the child
        signal.signal(number, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # printed text must not mix with the answers
    module, name = pickle.load(sys.stdin.buffer)
    function = getattr(importlib.import_module(module), name)
    answer: Any = True  # sent first: the child is ready
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            pickle.dump(answer, answers, 5)
            answers.flush()
            item = pickle.load(sys.stdin.buffer)
            try:
                answer = function(item), None
            except Exception as error:  # the parent raises it
                answer = None, _picklable(error)


def _picklable(error):
    """Return the exception, or a RuntimeError with its text if pickle cannot rebuild it."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # an exception's class may define how it is pickled, and fail in any way
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error
