"""How kernels come to be compiled: at their first call for a law, unless they are kept on disk.

What is said of it, what it is spared, and how another process does it meanwhile.
"""

import atexit
import contextlib
import functools
import gc
import inspect
import re
import subprocess
import sys
import warnings
from typing import Any

from numba.core import targetconfig

from ..errors import CompilationError, RunWarning
from ..friction.law import FrictionLaw
from ..friction.user_law import MARK
from .cache import report
from .vectorisation import is_vectorised

_called: set = set()  # (kernel, law): here, at least once
_announced: set = set()  # those of which `announce` has said something
_slow: set = set()  # laws of which `call` has warned
_elsewhere: dict = {}  # (kernel, law) -> the process that compiles it


def call(kernel, *arguments):
    """What a kernel returns; an exception becomes a `CompilationError`: compiled code has none.

    `RunWarning`, once, for a user's law for which the loops over lanes are compiled but not
    vectorised.
    """
    law = law_among(arguments)
    known = (kernel, law) in _called
    try:
        with contextlib.nullcontext() if known else _quick_compilation():
            result = kernel(*arguments)
    except Exception as error:  # none of a case's: compiled code has but status codes
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        if law is not None and MARK in law.name:
            raise CompilationError(
                f"the law {law.name} cannot be compiled: {_why(error, law)}; its methods may hold "
                f"arithmetic, math and what else numba knows"
            ) from error
        raise CompilationError(
            f"the solver cannot be compiled on this machine ({reason}); no parameter is at fault: "
            f"free memory, or install ratestate and numba anew, and run the same again"
        ) from error
    _called.add((kernel, law))
    if not known and (kernel, law) in _announced:
        _warn_of_slow_loops(kernel, law)
    return result


def _warn_of_slow_loops(kernel, law):
    """Warn where a user's law has kept a kernel from being vectorised, once a law."""
    if MARK not in law.name or law in _slow or is_vectorised(kernel._cache.products[law.name]):
        return
    _slow.add(law)
    text = (
        f"law {law.name}: the compiled loop over sliders is not vectorised, so that sweeps take "
        f"several times as long as with a built-in law; most often a function such as math.log or "
        f"math.exp in its methods is the cause (exponentials belong in `exponents`), more rarely a "
        f"branch (if)"
    )
    warnings.warn(text, RunWarning, stacklevel=3)


def _why(error, law):
    """What the compiler's message names as the cause, and where in the law."""
    text = str(error)
    causes = re.findall(
        r"^\s*((?:No impl|Unknown|Invalid|Cannot|Use of|Untyped|name ').*)$", text, re.M
    )
    reason = (causes or [line for line in text.splitlines() if line] or [type(error).__name__])[-1]
    places = re.findall(r'File "([^"]+)", line (\d+)', text)
    own = inspect.getfile(type(law))
    lines = [line for file, line in places if own.endswith(file)]
    return reason + (f" ({own}, line {lines[-1]})" if lines else "")


def law_among(arguments):
    """The law among a kernel's arguments; None where it takes none."""
    return next((one for one in arguments if isinstance(one, FrictionLaw)), None)


def announce(kernel, law):
    """Say on stderr that a kernel is about to be compiled for a law, if it is not on disk.

    Where another process compiles it, this one waits for that.
    """
    if _is_there(kernel, law):
        return
    process = _elsewhere.pop((kernel, law), None)
    another = "" if kernel._cache.is_empty() and not _announced else "another part of "
    if (kernel, law) not in _announced and not (process and _announced):
        report(f"compiling {another}the solver for this machine, once, about 10 s")
    _announced.add((kernel, law))
    if process:
        process.wait()


def compile_elsewhere(kernel, law, statement):
    """Let another process compile a kernel for a law, while this one does something else.

    Nothing is done where the kernel is on disk.  Where the other process fails, or cannot keep the
    kernel, the first call compiles it.

    statement : str of Python that calls the kernel for this law
    """
    if _is_there(kernel, law) or (kernel, law) in _elsewhere:
        return
    nowhere = subprocess.DEVNULL
    with contextlib.suppress(OSError):
        command = [sys.executable, "-P", "-c", statement]  # (nothing is imported from here)
        process = subprocess.Popen(command, stdin=nowhere, stdout=nowhere, stderr=nowhere)
        atexit.register(process.kill)  # without effect where it has ended
        _elsewhere[kernel, law] = process


def _is_there(kernel, law):
    """Whether the kernel was called for this law, or is on disk, or the compiler is off."""
    return (kernel, law) in _called or not hasattr(kernel, "_cache") or kernel._cache.kept(law)


@contextlib.contextmanager
def _quick_compilation():
    """Leave out what takes a third of the time of compiling, and brings nothing.

    Of what a compiler allocates little is garbage.  And numba looks functions up by their flags,
    some forty, which it then collects by name: they are hashed and compared as before, but at once.
    """
    config: Any = targetconfig.TargetConfig
    if "_values" in config.__slots__ and hasattr(config, "options"):  # as in numba 0.68
        config.__hash__, config.__eq__ = _hash_of_flags, _equal_flags
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def _hash_of_flags(flags):
    """What `TargetConfig.__hash__` gives: a hash of the names of all options."""
    return _names_and_defaults(flags.__class__)[0]


def _equal_flags(flags, other):
    """What `TargetConfig.__eq__` gives."""
    if type(other) is not type(flags):
        return NotImplemented
    mine, its = flags._values, other._values  # those that differ from the default, and others
    defaults = _names_and_defaults(flags.__class__)[1]
    return mine == its or defaults | mine == defaults | its


@functools.cache
def _names_and_defaults(flags):
    """The hash of the names of a class's options, and the dict of their defaults."""
    defaults = {name: option.default for name, option in flags.options.items()}
    return hash(tuple(sorted(defaults))), defaults
