"""Functions that children compute in the tests of processes.py."""

import os
import sys
import time


def squared(item):
    """(square, process) of a number; a little later, so that all processes take part."""
    time.sleep(0.05)
    return item * item, os.getpid()


def dies_elsewhere(item):
    """The number, but only in this process: another one ends at once."""
    number, parent = item
    if os.getpid() != parent:
        os._exit(3)
    time.sleep(0.2)
    return number


def refuses(item):
    """An error at 3."""
    time.sleep(0.05)
    if item == 3:
        raise ValueError(f"no {item}")
    return item


def prints(item):
    """The number; what is printed must not get between the answers."""
    sys.stdout.write("printed")
    time.sleep(0.05)
    return item


class TwoTexts(Exception):
    """An exception that pickle cannot build again from its arguments."""

    def __init__(self, first, second):
        super().__init__(first)
        self.second = second


def ends_oddly(way):
    """End this process with an exit code, or raise `TwoTexts`."""
    if way == "exit":
        sys.exit(5)
    raise TwoTexts("first", "second")
