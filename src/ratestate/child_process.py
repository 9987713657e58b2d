"""A child process that computes one item after the other: of records, files and sweeps.

A child is a new interpreter that imports the function's module and nothing else (0.3 s): no fork,
for other threads may run, and no import of ``__main__``, which therefore needs no guard.  It gets
pickled items through its stdin, and sends a pickled result or exception for each.
"""

import contextlib
import importlib
import os
import pickle
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

is_child = False  # whether this process is such a child


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
