"""Readers that go wrong, for the child that `read_isolated` lets them run in."""

import os
import signal
import sys
import time
import warnings

import numpy as np

from ratestate import ParameterError


def good(path):
    """Arrays of several kinds and layouts, and in which process they were made."""
    os.write(1, b"not for the parent")
    warnings.warn("odd", UserWarning, stacklevel=1)
    x = np.arange(6.0).reshape(2, 3)
    return {"x": x, "column": x[:, 1], "turned": x.T, "none": x[:0], "text": path.read_text()}, (
        os.getpid(),
        "__main__" in sys.modules and getattr(sys.modules["__main__"], "__file__", None),
    )


def killed(path):
    os.kill(os.getpid(), signal.SIGSEGV)


def left(path):
    os._exit(7)


def endless(path):
    while True:
        time.sleep(0.1)


def greedy(path):
    return np.zeros(2**28)  # 2 GB


def refused(path):
    raise ParameterError(f"{path.name} is not wanted")


def stumbled(path):
    raise IndexError("x" * 1000)


def nested(path):
    return nested(path)


def checksum(path, more):
    return sum(path.open("rb").read()), more
