"""Compiled kernels on disk: each in one file of a name of its own, checked before it is used.

numba's own cache goes stale when a function in another file changes, loads machine code without a
look at it, and ends a call for a file that is damaged or a disk that is full.  Here the folder's
name is a hash of all the kernels' sources, a file's name one of all else that the machine code
depends on, and a file begins with the SHA-256 of its content.  A kernel that cannot be loaded is
compiled anew; one that cannot be kept is used all the same.  With the code goes what was counted in
it when it was compiled: machine code that is loaded has no text.
"""

import contextlib
import functools
import hashlib
import os
import pickle
import stat
import sys
import sysconfig
import tempfile
import uuid
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite
import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.registry import cpu_target
from numba.core.serialize import dumps

from .vectorisation import products

CHECKSUM = hashlib.sha256().digest_size
#: what machine code depends on, beside its sources, the types of its arguments and the processor
PROGRAMS = (numba.__version__, llvmlite.__version__, sysconfig.get_config_var("SOABI"))


def _digest():
    """A hash of all sources of the kernels."""
    package = Path(__file__).parent.parent
    sources = (package / folder for folder in ("engine", "friction", "model"))
    paths = sorted(path for folder in sources for path in folder.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


DIGEST = _digest()


class KernelCache(_Cache):
    """What numba asks for, and hands, the compiled code of one function.

    Parameters
    ----------
    function : the function that is compiled
    name : by which its code is kept
    """

    def __init__(self, function, name):
        self._name = f"{function.__module__.rpartition('.')[2]}.{name}"
        self._enabled = True
        #: name of a law, "" of none -> `vectorisation.products` of the code compiled or loaded
        self.products: dict[str, tuple[int, int]] = {}

    @property
    def cache_path(self):
        """The folders from which kernels are loaded, as one text."""
        return os.pathsep.join(map(str, _readable()))

    def load_overload(self, sig, target_context):
        """The code for these types of arguments; None if it must be compiled.

        A file that is damaged is reported on stderr, and one that cannot be read passed over.
        """
        target_context.refresh()
        if not self._enabled:
            return None
        file = self._file(sig, target_context.codegen())
        for folder in _readable():
            path = folder / file
            try:
                content = path.read_bytes()
            except OSError:  # most often it is not there
                continue
            checksum, code = content[:CHECKSUM], content[CHECKSUM:]
            if hashlib.sha256(code).digest() == checksum:
                with contextlib.suppress(Exception):  # of another build of numba, say
                    counted, parts = pickle.loads(code)
                    result = CompileResult._rebuild(target_context, *parts)
                    self.products[_law_name(sig)] = counted
                    return result
            say(f"the compiled kernel {path} is damaged; it is compiled anew")
        return None

    def save_overload(self, sig, data):
        """Keep compiled code in the first folder that takes it; tell on stderr which do not."""
        counted = self.products[_law_name(sig)] = products(data.library)
        if not self._enabled or data.library.has_dynamic_globals:  # (addresses of this process)
            return
        code = dumps((counted, data._reduce()))
        content = hashlib.sha256(code).digest() + code
        refusals = []
        for folder in _folders():
            try:
                folder.make()
                _write(folder.path / self._file(sig, data.codegen), content)
            except OSError as error:
                refusals.append(f"{folder.path} ({error.strerror or error})")
                continue
            if refusals:
                say(f"compiled kernels cannot be kept in {refusals[0]}; they are in {folder.path}")
            return
        say(
            f"compiled kernels cannot be kept in {' nor in '.join(refusals)}: each process "
            f"compiles its own; make room, or set XDG_CACHE_HOME to a folder that can be written to"
        )

    @staticmethod
    def is_empty():
        """Whether no kernel is there."""
        return not any(any(folder.glob("*.nbc")) for folder in _readable())

    def kept(self, law):
        """Whether code for this law is there, for some types of the other arguments."""
        files = f"{self._name}-{law.name}-{_machine(cpu_target.target_context.codegen())}-*.nbc"
        return any(any(folder.glob(files)) for folder in _readable())

    def _file(self, sig, codegen):
        law = _law_name(sig)
        name = f"{self._name}-{law}" if law else self._name
        return f"{name}-{_machine(codegen)}-{_short_hash(sig)}.nbc"

    def enable(self):
        """Load and keep code from now on."""
        self._enabled = True

    def disable(self):
        """Neither load nor keep code from now on."""
        self._enabled = False

    def flush(self):
        """Remove what is kept; OSError where that is not possible."""
        for folder in _readable():
            for path in folder.glob(f"{self._name}-*.nbc"):
                path.unlink(missing_ok=True)


def _law_name(sig):
    """The name of the law among the types of a kernel's arguments; "" where it takes none."""
    return next((one.law.name for one in sig if hasattr(one, "law")), "")


def _machine(codegen):
    """What of a file's name tells for which programs, and which kind of processor, it is."""
    return _short_hash((PROGRAMS, codegen.magic_tuple()))


def _short_hash(value):
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]


class _Folder(NamedTuple):
    """A folder for kernels; private: in one of its own, in a place where anybody may write."""

    path: Path
    private: bool

    def make(self):
        """Make it, unless it is there; OSError if it cannot be had."""
        if self.private:
            self.path.parent.mkdir(mode=0o700, exist_ok=True)
            if not self.safe():
                raise PermissionError(f"{self.path.parent} is not this user's alone")
        self.path.mkdir(parents=True, exist_ok=True)

    def safe(self):
        """Whether nobody else can have put code there."""
        if not self.private or not hasattr(os, "getuid"):
            return True
        try:
            found = self.path.parent.lstat()
        except OSError:
            return False
        own = stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
        return own and not stat.S_IMODE(found.st_mode) & 0o077


def _folders():
    """Where kernels are kept: with the user's caches or, if they take none, a temporary folder."""
    config: Any = numba.config  # it sets its attributes at run time
    base: Any = config.CACHE_DIR or os.environ.get("XDG_CACHE_HOME")
    name, found = f"kernels-{DIGEST}", []
    with contextlib.suppress(RuntimeError):  # no home
        base = Path(base or Path.home() / ".cache")
        found.append(_Folder(base / "ratestate" / name, private=False))
    with contextlib.suppress(FileNotFoundError):  # no folder for temporary files
        user = f"ratestate-{os.getuid()}" if hasattr(os, "getuid") else "ratestate"
        found.append(_Folder(Path(tempfile.gettempdir()) / user / name, private=True))
    return found


def _readable():
    """The folders from which kernels are loaded."""
    return [folder.path for folder in _folders() if folder.safe()]


def _write(path, content):
    """Write a file that is whole or absent, whoever else writes it."""
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()


@functools.cache
def say(text):
    """`report` a line, once in this process."""
    report(text)


def report(text):
    """Write a line on stderr; nothing where there is no stderr."""
    if sys.stderr:
        sys.stderr.write(f"ratestate: {text}\n")
        sys.stderr.flush()
