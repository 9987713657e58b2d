"""What of the machine this process may use: cores, memory and child processes.

A container, or a job of a scheduler, sees all cores and all memory of its machine, and is held to
the limits of its control group (cgroup; version 2, or 1, which has a tree for each resource).

A child process computes one item after the other, for records, files and sweeps.  It is a new
interpreter that imports the function's module and nothing else (0.3 s): no fork, for other threads
may run, and no import of ``__main__``, which therefore needs no guard.  It gets pickled items
through its stdin, and sends a pickled result or exception for each.
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
GROUPS, MOUNTED = Path("/proc/self/cgroup"), Path("/sys/fs/cgroup")


def cores():
    """How many cores this process may use, an int >= 1.

    The least of those that it may run on, of its control group's quota of their time, rounded up,
    and of NUMBA_NUM_THREADS in the environment.
    """
    here = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else ()
    limits = [len(here) or os.cpu_count() or 1, *_quotas()]
    wanted = os.environ.get("NUMBA_NUM_THREADS", "")
    if wanted.isdecimal() and int(wanted) > 0:
        limits.append(int(wanted))
    return min(limits)


@functools.cache
def _quotas():
    """Cores whose time this process's control groups may take, rounded up, for each that says."""
    found = []
    for folder in _folders("cpu"):
        share = _numbers(folder / "cpu.max")  # quota and period, of version 2, and of 1
        share += _numbers(folder / "cpu.cfs_quota_us") + _numbers(folder / "cpu.cfs_period_us")
        if len(share) == 2 and 0.0 < share[0] < math.inf:  # (-1 or "max": none)
            found.append(math.ceil(share[0] / share[1]))
    return found


#: bytes that any process has, so that for less the system need not be asked
AMPLE = 1e3


def memory():
    """Bytes of memory that this process may have; inf where the system does not say."""
    limits = [math.inf]
    if hasattr(os, "sysconf"):
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    for folder in _folders("memory"):
        limits += _numbers(folder / "memory.max") + _numbers(folder / "memory.limit_in_bytes")
    return min(limits)


def check_fits(size, what, remedy):
    """Raise ParameterError if so many bytes are more than this process may have.

    what, remedy : str, the subject of the message, in the plural, and how to get by with less
    """
    if size > AMPLE and size > (most := memory()):
        raise ParameterError(
            f"{what} take {size / 1e9:,.3g} GB of memory, and {most / 1e9:,.3g} GB are there; "
            f"{remedy}"
        )


def _folders(resource):
    """Folders with the limits of this process's group and those around it."""
    try:
        lines = GROUPS.read_text().splitlines()
    except OSError:  # no Linux
        return []
    found = []
    for line in lines:
        _, names, path = line.split(":", 2)
        if not names or resource in names.split(","):
            top = MOUNTED / names
            inside = top / path.lstrip("/")
            found += [f for f in (inside, *inside.parents) if f.is_relative_to(top)]
    return found


def _numbers(file):
    """The numbers in a file of limits; none where there is no such file."""
    try:
        return [math.inf if word == "max" else float(word) for word in file.read_text().split()]
    except (OSError, ValueError):
        return []


class ChildDied(Exception):
    """The child has ended, or could not be started."""


class Child:
    """A child process, which ends with the context.

    function : of a module, not of ``__main__``; items and results can be pickled
    stderr : as of `subprocess.Popen`

    `ready` is whether it has imported the function.
    """

    def __init__(self, function, stderr=None):
        self.name, self.stderr = (function.__module__, function.__qualname__), stderr
        self.process: Any = None
        self.ready = False

    def __enter__(self):
        places = os.pathsep.join(place or str(Path.cwd()) for place in sys.path)
        alone = {"PYTHONPATH": places, "OPENBLAS_NUM_THREADS": "1"}
        with contextlib.suppress(OSError):  # then `call` says so
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {__name__} import serve; serve()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.stderr,
                env=os.environ | alone,
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
        """End the process."""
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
        except Exception:  # it died before it had read all, or while it sent; or its answer is odd
            self.kill()
            raise ChildDied from None
        if error is not None:
            raise error
        return result

    def ending(self):
        """Wait for the end of a process that died; return its signal or exit code in words."""
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
    """Compute items from stdin until there are no more: the main loop of a child."""
    global is_child
    is_child = True
    for number in (signal.SIGINT, signal.SIGTERM):  # the parent gets these too, and ends this
        signal.signal(number, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever is printed must not mix with the answers
    module, name = pickle.load(sys.stdin.buffer)
    function = getattr(importlib.import_module(module), name)
    answer: Any = True  # it is ready
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            pickle.dump(answer, answers, 5)
            answers.flush()
            item = pickle.load(sys.stdin.buffer)
            try:
                answer = function(item), None
            except Exception as error:  # raised in the parent
                answer = None, error
