"""What of the machine this process may use: cores and memory.

A container, or a job of a scheduler, sees all cores and all memory of its machine, and is held to
the limits of its control group (cgroup; version 2, or 1, which has a tree for each resource).
"""

import functools
import math
import os
from pathlib import Path

from .errors import ParameterError

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
