"""Compiled kernels on disk: each in one file of a name of its own, checked before it is used.

numba's own cache goes stale when a function in another file changes, loads machine code without a
look at it, and ends a call for a file that is damaged or a disk that is full.  Here the folder's
name is a hash of all the kernels' sources, a file's name one of all else that the machine code
depends on, and a file begins with the SHA-256 of its content.  A kernel that cannot be loaded is
compiled anew; one that cannot be kept is used all the same.  With the code goes what was counted in
it when it was compiled: machine code that is loaded has no text.

Loading a file runs what is in it.  So only files and folders are used that nobody but this user
can have written (`_distrust`, `_read`).
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
from typing import Any

import llvmlite
import numba
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.registry import cpu_target
from numba.core.serialize import dumps

from ..friction.user_law import is_unchanged
from .vectorisation import products

CHECKSUM = hashlib.sha256().digest_size
#: what machine code depends on, beside its sources, the types of its arguments and the processor
PROGRAMS = (numba.__version__, llvmlite.__version__, sysconfig.get_config_var("SOABI"))


def _digest():
    """A hash of all sources of the kernels: the packages engine and friction, whole."""
    package = Path(__file__).parent.parent
    folders = package / "engine", package / "friction"
    paths = sorted(path for folder in folders for path in folder.rglob("*.py"))
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
        return os.pathsep.join(map(str, _folders()))

    def load_overload(self, sig, target_context):
        """The code for these types of arguments; None if it must be compiled.

        A file that is damaged, or another user may have written, is reported on stderr; one that
        cannot be read is passed over.
        """
        target_context.refresh()
        if not self._enabled:
            return None
        file = self._file(sig, target_context.codegen())
        for folder in _folders():
            path = folder / file
            if (content := _read(path)) is None:
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
        """Keep compiled code in the first folder that takes it; tell on stderr which do not.

        Code of a law that has changed since it was registered is not kept: its name says otherwise.
        """
        counted = self.products[_law_name(sig)] = products(data.library)
        if not self._enabled or data.library.has_dynamic_globals:  # (addresses of this process)
            return
        if (law := _law_of(sig)) and not is_unchanged(law):
            return
        code = dumps((counted, data._reduce()))
        content = hashlib.sha256(code).digest() + code
        refusals = []
        for folder in _folders():
            try:
                for part in (*reversed(folder.parents), folder):
                    with contextlib.suppress(FileExistsError, IsADirectoryError):
                        part.mkdir(mode=0o700)
                _write(folder / self._file(sig, data.codegen), content)
            except OSError as error:
                refusals.append(f"{folder} ({error.strerror or error})")
                continue
            if refusals:
                say(f"compiled kernels cannot be kept in {refusals[0]}; they are in {folder}")
            return
        say(
            f"compiled kernels cannot be kept in {' nor in '.join(refusals) or 'any folder'}: each "
            f"process compiles its own; make room, or set XDG_CACHE_HOME to a folder that can be "
            f"written to"
        )

    @staticmethod
    def is_empty():
        """Whether no kernel is there."""
        return not any(any(folder.glob("*.nbc")) for folder in _folders())

    def kept(self, law):
        """Whether code for this law is there, for some types of the other arguments."""
        files = f"{self._name}-{law.name}-{_machine(cpu_target.target_context.codegen())}-*.nbc"
        return any(any(folder.glob(files)) for folder in _folders())

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
        for folder in _folders():
            for path in folder.glob(f"{self._name}-*.nbc"):
                path.unlink(missing_ok=True)


def _law_of(sig):
    """The law among the types of a kernel's arguments, or None."""
    return next((one.law for one in sig if hasattr(one, "law")), None)


def _law_name(sig):
    law = _law_of(sig)
    return law.name if law else ""


def _machine(codegen):
    """The part of a file's name that stands for the programs and the kind of processor."""
    return _short_hash((PROGRAMS, codegen.magic_tuple()))


def _short_hash(value):
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]


def _folders():
    """Where kernels are kept: with the user's caches or, if they take none, a temporary folder.

    A folder that others may have put code into is left out, which is said on stderr.
    """
    config: Any = numba.config  # it sets its attributes at run time
    base: Any = config.CACHE_DIR or os.environ.get("XDG_CACHE_HOME")
    name, found = f"kernels-{DIGEST}", []
    with contextlib.suppress(RuntimeError):  # no home
        found.append(Path(base or Path.home() / ".cache").resolve() / "ratestate" / name)
    with contextlib.suppress(FileNotFoundError):  # no folder for temporary files
        temporary = Path(tempfile.gettempdir()).resolve()
        found.append(temporary / f"ratestate-{os.geteuid()}" / name)
    reasons = {folder: _distrust(folder) for folder in found}
    for folder, reason in reasons.items():
        if reason:
            say(f"compiled kernels in {folder.parent} are not used: {reason}")
    return [folder for folder, reason in reasons.items() if not reason]


def _distrust(kernels):
    """Why another user may have put code into this folder; "" if nobody can have.

    It and the folder around it, ratestate's own, must be this user's, and nobody else may write to
    them.  Those above must be this user's or root's.  Anybody may write to these only under the
    sticky bit, by which nobody can replace what is another's.

    kernels : Path without links above ratestate's own folder
    """
    own, user = kernels.parent, os.geteuid()
    for folder in (kernels, *kernels.parents):
        try:
            found = folder.lstat()
        except OSError:  # it is not there
            continue
        inside = folder in (kernels, own)
        if found.st_uid != user and (inside or found.st_uid != 0):
            return f"{folder} belongs to another user. Set XDG_CACHE_HOME to a folder of your own."
        if inside and not stat.S_ISDIR(found.st_mode):
            return f"{folder} is a link or a file. Remove it."
        if inside and found.st_mode & 0o022:
            return f"other users may write to {folder}. Run: chmod -R go-w {own}"
        if found.st_mode & stat.S_IWOTH and not found.st_mode & stat.S_ISVTX:
            return f"other users may write to {folder}. Run: chmod o-w {folder}"
    return ""


def _read(path):
    """The bytes of a file that nobody but this user can have written; None if there is none."""
    with contextlib.suppress(OSError):  # most often it is not there
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(handle, "rb") as file:
            found = os.fstat(handle)
            mine = found.st_uid == os.geteuid() and not found.st_mode & 0o022
            if mine and stat.S_ISREG(found.st_mode):
                return file.read()
        say(f"the compiled kernel {path} may be another user's; it is compiled anew")
    return None


def _write(path, content):
    """Write a file that is whole or absent, whoever else writes it."""
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.partial")
    try:
        partial.touch(mode=0o600)  # whatever the umask: see `_read`
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
