"""Foreign binary files, read in a process of their own.

What an HDF5 or MAT file holds goes into compiled code that trusts it: a damaged one may end the
process that reads it (SIGSEGV, SIGBUS), ask for any amount of memory, or never come to an end.  So
a child reads it, under limits, and hands the arrays back through a pipe.

The child is a new interpreter that imports the reader and nothing else (0.3 s): no fork,
for other threads may run, and no import of ``__main__``, which therefore needs no guard.  Memory
is limited where the system does that (Linux), processor time on any POSIX, time everywhere.
"""

import contextlib
import importlib
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path

from ...errors import ParameterError
from ..messages import reading as sentences

#: what a child may take for itself, and more of it for each byte of the file
MEMORY, MEMORY_EACH = 1024**3, 20  # bytes
SECONDS, SECONDS_EACH = 60.0, 1e-6
READY = b"+"
EVERY = 0.05  # seconds between looks at whether it is to stop
_is_child = False  # whether this process is such a child
LONGEST = 300  # characters of a reader's error message


def read_isolated(reader, path, kind, *more, seconds=None, stop=None):
    """The result of `reader` on a file; if it crashes, only its child process does.

    reader : function of the file and `more`, of a module; what it returns can be pickled
    path : Path of a file that exists, else OSError; or a `MemoryFile`
    kind : as what the file is read, in messages: "HDF5"
    more : further arguments of the reader, which can be pickled
    seconds : longest time [s]; None: `SECONDS`, and `SECONDS_EACH` byte
    stop : threading.Event that ends the child once it is set, or None

    A ParameterError of the reader is raised, and one for any other failure: an exception, a crash,
    too long a time, too much memory, `stop`.  Its warnings are issued here, each once.  Where no
    process can be had, and in such a child, the file is read in this process.
    """
    if _is_child:
        return reader(path, *more)
    size = path.stat().st_size
    seconds = SECONDS + SECONDS_EACH * size if seconds is None else seconds
    memory = MEMORY + MEMORY_EACH * size
    stop = threading.Event() if stop is None else stop
    start, ready, answer = time.monotonic(), False, None
    try:
        process = _start(reader, memory, seconds)
    except OSError:  # of the system, not of the file: it is read here
        return reader(path, *more)
    with process, _ended_by(process, stop, seconds):
        with contextlib.suppress(OSError):  # the process died before it had read all
            pickle.dump((path, more), process.stdin, 5)
            process.stdin.close()
        ready = process.stdout.read(1) == READY
        if ready:
            with contextlib.suppress(Exception):  # the process died while it sent
                answer = pickle.load(process.stdout)
        if answer is None:
            process.wait()
    if answer is not None:
        result, error, failure, messages = answer
        for message, category in messages:
            warnings.warn(f"{path.name}: {message}", category, stacklevel=3)
        if error is not None:
            raise error
        if not failure:
            return result
    elif stop.is_set():
        failure = "it was stopped"
    elif time.monotonic() - start >= seconds:
        failure = f"it took more than {seconds:.0f} s"
    elif ready:
        failure = f"it ended the process that read it ({_ending(process.returncode)})"
    else:  # no such process is to be had here: the file is not to blame
        return reader(path, *more)
    raise sentences.refusal("file.child", name=path.name, kind=kind, failure=failure[:LONGEST])


def _start(reader, memory, seconds):
    """The child; it can import what this process can."""
    places = [place or str(Path.cwd()) for place in sys.path]
    own = {"PYTHONPATH": os.pathsep.join(places), "OPENBLAS_NUM_THREADS": "1"}
    what = [reader.__module__, reader.__qualname__, str(memory), str(int(seconds) + 1)]
    return subprocess.Popen(
        [sys.executable, "-P", "-c", f"from {__name__} import _serve; _serve()", *what],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=os.environ | own,
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )


@contextlib.contextmanager
def _ended_by(process, stop, seconds):
    """Kill the process once `stop` is set, after so many seconds, and at the end of the block."""
    over = threading.Event()

    def watch():
        end = time.monotonic() + seconds
        while not (over.is_set() or stop.is_set()) and time.monotonic() < end:
            over.wait(min(EVERY, max(end - time.monotonic(), 0.0)))
        process.kill()

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


def _serve():
    """Read a file and send what is in it: what a child does."""
    global _is_child
    _is_child = True
    module, name, memory, seconds = sys.argv[1:]
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that nothing else gets in between
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it, or lets it end
    reader = getattr(importlib.import_module(module), name)
    path, more = pickle.load(sys.stdin.buffer)
    _limit(int(memory), int(seconds))
    answers.write(READY)
    answers.flush()
    result, error, failure = None, None, ""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            result = reader(path, *more)
        except ParameterError as refused:
            error = refused
        except MemoryError:
            failure = f"it asks for more memory than {int(memory) / 1e9:.1f} GB"
        except Exception as other:
            failure = f"{type(other).__name__}: {other}"
    messages = dict.fromkeys((str(one.message), one.category) for one in caught)
    pickle.dump((result, error, failure, [*messages]), answers, 5)
    answers.flush()
    os._exit(0)  # what the file has spoilt is not cleared away


def _limit(memory, seconds):
    """Limit this process, as far as the system can."""
    with contextlib.suppress(ImportError):  # Windows
        import resource

        for name, most in (("AS", memory), ("CPU", seconds), ("CORE", 0)):
            which = getattr(resource, f"RLIMIT_{name}")
            hard = resource.getrlimit(which)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            with contextlib.suppress(ValueError, OSError):  # macOS knows no limit of memory
                resource.setrlimit(which, (most, hard))
