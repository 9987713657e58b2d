"""Work spread over processes: this one and children, each on one core.

A child is a new interpreter that imports the function's module and nothing else: no fork, for other
threads may run, and no import of ``__main__``, which therefore needs no guard.
"""

import contextlib
import importlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

from ...machine import cores

#: fewest items for each child: it takes a second or two to start
FEWEST = 4


def mapped(function, items, report=None):
    """list of ``function(item)`` for each item, computed by this process and by children.

    function : of a module, not of ``__main__``; items and results can be pickled
    report : function of how many are done, called in this thread, or None

    An exception of the function is raised once what is under way has ended.  What a child that
    dies had under way is computed here.
    """
    items = list(items)
    results: list[Any] = [None] * len(items)
    todo: queue.SimpleQueue = queue.SimpleQueue()
    for numbered in enumerate(items):
        todo.put(numbered)
    done = [0]
    errors: list[BaseException] = []

    def work(compute):
        """Compute items until there are none, an error occurred, or the child has died."""
        while not errors:
            try:
                i, item = todo.get_nowait()
            except queue.Empty:
                return
            try:
                results[i] = compute(item)
            except _ChildDied:
                todo.put((i, item))
                return
            except BaseException as error:
                errors.append(error)
                return
            done[0] += 1
            if report is not None and threading.current_thread() is here:
                report(done[0])

    here = threading.current_thread()
    with contextlib.ExitStack() as stack:
        threads = []
        for _ in range(min(cores() - 1, len(items) // FEWEST)):
            child = stack.enter_context(_Child(function))
            threads.append(threading.Thread(target=work, args=(child.call,), daemon=True))
            threads[-1].start()
        work(function)
        if errors and isinstance(errors[0], KeyboardInterrupt):
            raise errors[0]  # children are killed
        for thread in threads:
            thread.join()
        work(function)  # what children that died have left
    if errors:
        raise errors[0]
    return results


class _ChildDied(Exception):
    """The child has ended, or could not be started."""


class _Child:
    """A child process that computes one item after the other."""

    def __init__(self, function):
        self.name = function.__module__, function.__qualname__
        self.process: Any = None

    def __enter__(self):
        places = os.pathsep.join(place or str(Path.cwd()) for place in sys.path)
        alone = {"PYTHONPATH": places, "NUMBA_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        with contextlib.suppress(OSError):  # where no process can be had, this one does all
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {__name__} import _serve; _serve()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env=os.environ | alone,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
            self._send(self.name)
        return self

    def __exit__(self, *_):
        if self.process is not None:
            self.process.kill()
            with contextlib.suppress(OSError):
                self.process.communicate()

    def call(self, item):
        """The function's result for an item; its exception is raised here."""
        if self.process is None:
            raise _ChildDied
        try:
            self._send(item)
            result, error = pickle.load(self.process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            raise _ChildDied from None
        if error is not None:
            raise error
        return result

    def _send(self, thing):
        pickle.dump(thing, self.process.stdin, 5)
        self.process.stdin.flush()


def _serve():
    """Compute items from stdin until there are no more: what a child does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever is printed must not mix with the answers
    module, name = pickle.load(sys.stdin.buffer)
    function = getattr(importlib.import_module(module), name)
    with contextlib.suppress(EOFError, BrokenPipeError):
        while True:
            item = pickle.load(sys.stdin.buffer)
            result, failure = None, None
            try:
                result = function(item)
            except Exception as error:  # raised in the parent
                failure = error
            pickle.dump((result, failure), answers, 5)
            answers.flush()
