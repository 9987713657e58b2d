"""Child processes: work spread over them, and foreign files read in one under limits.

A child is a new interpreter that imports the function's module and nothing else (0.3 s): no fork,
for other threads may run, and no import of ``__main__``, which therefore needs no guard.

What an HDF5 or MAT file holds goes into compiled code that trusts it: a damaged one may end the
process that reads it (SIGSEGV, SIGBUS), ask for any amount of memory, or never come to an end.  So
a child reads it.  Memory is limited if the system does that (Linux), processor time on any POSIX,
time everywhere.
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
import time
import warnings
from pathlib import Path
from typing import Any

from ...errors import ParameterError
from ...machine import cores
from ..messages import kit as sentences

#: fewest items for each child: it takes a second or two to start
FEWEST = 4
#: what a reader may take for itself, and more of it for each byte of the file
MEMORY, MEMORY_EACH = 1024**3, 20  # bytes
SECONDS, SECONDS_EACH = 60.0, 1e-6
EVERY = 0.05  # seconds between looks at whether it is to stop
LONGEST = 300  # characters of a reader's error message
_is_child = False  # whether this process is such a child


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


def read_isolated(reader, path, kind, *more, seconds=None, stop=None):
    """The result of `reader` on a file; if it crashes, only its child process does.

    reader : function of the file and `more`, of a module; its result can be pickled
    path : Path of a file that exists, else OSError; or a `MemoryFile`
    kind : as what the file is read, in messages: "HDF5"
    more : further arguments of the reader, which can be pickled
    seconds : longest time [s]; None: `SECONDS`, and `SECONDS_EACH` byte
    stop : threading.Event that ends the child once it is set, or None

    A ParameterError of the reader is raised, and one for any other failure: an exception, a crash,
    too long a time, too much memory, `stop`.  Its warnings are issued here, each once.  If no
    process can be had, and in a child, the file is read in this process.
    """
    if _is_child:
        return reader(path, *more)
    size = path.stat().st_size
    seconds = SECONDS + SECONDS_EACH * size if seconds is None else seconds
    limits = MEMORY + MEMORY_EACH * size, int(seconds) + 1
    stop = threading.Event() if stop is None else stop
    start, ready, failure = time.monotonic(), False, ""
    result, error, messages = None, None, []
    with _Child(_read, stderr=subprocess.DEVNULL) as child, _ended_by(child, stop, seconds):
        try:
            ready = child.call(None)
            names = reader.__module__, reader.__qualname__
            result, error, failure, messages = child.call((names, path, more, *limits))
        except _ChildDied:
            if stop.is_set():
                failure = "it was stopped"
            elif time.monotonic() - start >= seconds:
                failure = f"it took more than {seconds:.0f} s"
            elif ready:
                failure = f"it ended the process that read it ({_ending(child.process.wait())})"
            else:  # no process is to be had here, for which the file is not to blame
                return reader(path, *more)
    for message, category in messages:
        warnings.warn(f"{path.name}: {message}", category, stacklevel=3)
    if error is not None:
        raise error
    if failure:
        raise sentences.refusal("file.child", name=path.name, kind=kind, failure=failure[:LONGEST])
    return result


@contextlib.contextmanager
def _ended_by(child, stop, seconds):
    """Kill the child once `stop` is set, and after so many seconds."""
    over = threading.Event()

    def watch():
        end = time.monotonic() + seconds
        while not (over.is_set() or stop.is_set()) and time.monotonic() < end:
            over.wait(min(EVERY, max(end - time.monotonic(), 0.0)))
        child.kill()

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        over.set()
        watcher.join()


def _ending(code):
    """How a process ended, by its exit code."""
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"


def _read(task):
    """Read a file under limits, in a child: result, error, another failure, and warnings."""
    if task is None:
        return True
    (module, name), path, more, memory, seconds = task
    reader = getattr(importlib.import_module(module), name)
    _limit(memory, seconds)
    result, error, failure = None, None, ""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = reader(path, *more)
        except ParameterError as refused:
            error = refused
        except MemoryError:
            failure = f"it asks for more memory than {memory / 1e9:.1f} GB"
        except Exception as other:
            failure = f"{type(other).__name__}: {other}"
    messages = dict.fromkeys((str(one.message), one.category) for one in caught)
    return result, error, failure, [*messages]


def _limit(memory, seconds):
    """Limit this process, as far as the system can."""
    with contextlib.suppress(ImportError):  # Windows
        import resource

        for name, most in (("AS", memory), ("CPU", seconds), ("CORE", 0)):
            which = getattr(resource, f"RLIMIT_{name}")
            hard = resource.getrlimit(which)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            with contextlib.suppress(ValueError, OSError):  # macOS has no limit of memory
                resource.setrlimit(which, (most, hard))


class _ChildDied(Exception):
    """The child has ended, or could not be started."""


class _Child:
    """A child process that computes one item after the other."""

    def __init__(self, function, stderr=None):
        self.name, self.stderr = (function.__module__, function.__qualname__), stderr
        self.process: Any = None

    def __enter__(self):
        places = os.pathsep.join(place or str(Path.cwd()) for place in sys.path)
        alone = {"PYTHONPATH": places, "OPENBLAS_NUM_THREADS": "1"}
        with contextlib.suppress(OSError):  # where no process can be had, this one does all
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", f"from {__name__} import _serve; _serve()"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.stderr,
                env=os.environ | alone,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
            self._send(self.name)
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
        """The function's result for an item; its exception is raised here."""
        if self.process is None:
            raise _ChildDied
        task = pickle.dumps(item, 5)
        try:
            self.process.stdin.write(task)
            self.process.stdin.flush()
            result, error = pickle.load(self.process.stdout)
        except Exception:  # it died before it had read all, or while it sent; or its answer is odd
            self.kill()
            raise _ChildDied from None
        if error is not None:
            raise error
        return result

    def _send(self, thing):
        pickle.dump(thing, self.process.stdin, 5)
        self.process.stdin.flush()


def _serve():
    """Compute items from stdin until there are no more: what a child does."""
    global _is_child
    _is_child = True
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
