"""Parallel work in child processes, and reading files in a child process under limits.

Compiled code reads HDF5 and MAT files and trusts their contents.  A damaged file may end the
process (SIGSEGV, SIGBUS), request any amount of memory, or never come to an end.  So a child
process reads it.  Memory is limited on Linux, processor time on POSIX, and elapsed time everywhere.
"""

import contextlib
import importlib
import subprocess
import threading
import time
import warnings
from collections import deque

from ... import machine
from ...errors import ParameterError
from ...machine import Child, ChildDied, cores
from ..messages import kit as sentences

#: fewest items for each child, because a child takes a second or two to start
FEWEST = 4
#: limits of a reader, and their increase for each byte of the file
MEMORY, MEMORY_EACH = 1024**3, 20  # bytes
SECONDS, SECONDS_EACH = 60.0, 1e-6
EVERY = 0.05  # seconds between checks whether to stop
LONGEST = 300  # characters of a reader's error message


def mapped(function, items, report=None):
    """Return the list of ``function(item)``, computed by this process and by child processes.

    function : function of a module, not of ``__main__``.  Items and results can be pickled.
    report : function of the number of finished items, called in this thread, or None

    An exception of the function is raised after the running computations have ended.  If a child
    dies, this process computes its item.
    """
    items, results = list(items), {}
    errors: list[BaseException] = []
    todo = deque(enumerate(items))

    def work(compute):
        """Compute items until there are none, an error occurred, or the child has died."""
        while todo and not errors:
            try:
                i, item = todo.popleft()
            except IndexError:  # another thread took the last item
                return
            try:
                results[i] = compute(item)
            except ChildDied:
                todo.append((i, item))
                return
            except BaseException as error:
                errors.append(error)
                return
            if report is not None and threading.current_thread() is here:
                report(len(results))

    here = threading.current_thread()
    with contextlib.ExitStack() as stack:
        threads = []
        for _ in range(min(cores() - 1, len(items) // FEWEST)):
            child = stack.enter_context(Child(function))
            threads.append(threading.Thread(target=work, args=(child.call,), daemon=True))
            threads[-1].start()
        work(function)
        if errors and isinstance(errors[0], KeyboardInterrupt):
            raise errors[0]  # children are killed
        for thread in threads:
            thread.join()
        work(function)  # items of children that died
    if errors:
        raise errors[0]
    return [results[i] for i in range(len(items))]


def read_isolated(reader, path, kind, *more, seconds=None, stop=None):
    """Return the result of `reader` on a file; a crash ends only the child process.

    reader : function of a module, of the file and `more`.  Its result can be pickled.
    path : Path of an existing file (else OSError), or a `MemoryFile`
    kind : format of the file in messages, such as "HDF5"
    more : further arguments of the reader, which can be pickled
    seconds : time limit [s]; by default `SECONDS` and `SECONDS_EACH` byte
    stop : threading.Event that ends the child when it is set, or None

    A ParameterError of the reader is raised.  Any other failure (an exception, a crash, too much
    time or memory, `stop`) also raises ParameterError.  Each warning is issued once.  If no process
    can be started, or in a child, this process reads the file.
    """
    if machine.is_child:
        return reader(path, *more)
    size = path.stat().st_size
    seconds = SECONDS + SECONDS_EACH * size if seconds is None else seconds
    limits = MEMORY + MEMORY_EACH * size, int(seconds) + 1
    stop = threading.Event() if stop is None else stop
    start, failure = time.monotonic(), ""
    result, error, messages = None, None, []
    with Child(_read, stderr=subprocess.DEVNULL) as child, _ended_by(child, stop, seconds):
        try:
            names = reader.__module__, reader.__qualname__
            result, error, failure, messages = child.call((names, path, more, *limits))
        except ChildDied:
            if stop.is_set():
                failure = "it was stopped"
            elif time.monotonic() - start >= seconds:
                failure = f"it took more than {seconds:.0f} s"
            elif child.ready:
                failure = f"it ended the process that read it ({child.ending()})"
            else:  # no process could be started, which is not the fault of the file
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
    over = threading.Event()

    def watch():
        end = time.monotonic() + seconds
        while not (stop.is_set() or time.monotonic() >= end or over.wait(EVERY)):
            pass
        child.kill()

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        over.set()
        watcher.join()


def _read(task):
    """Read a file under limits; return result, ParameterError, other failure, and warnings."""
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
            failure = f"it needs more memory than {memory / 1e9:.1f} GB"
        except Exception as problem:  # a file can make any library fail that reads it
            failure = f"{type(problem).__name__}: {problem}"
    messages = dict.fromkeys((str(warning.message), warning.category) for warning in caught)
    return result, error, failure, [*messages]


def _limit(memory, seconds):
    with contextlib.suppress(ImportError):  # Windows
        import resource

        for name, most in (("AS", memory), ("CPU", seconds), ("CORE", 0)):
            which = getattr(resource, f"RLIMIT_{name}")
            hard = resource.getrlimit(which)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            with contextlib.suppress(ValueError, OSError):  # macOS cannot limit memory
                resource.setrlimit(which, (most, hard))
