"""Machine code on disk: each object in one file of a name of its own, checked before it is used.

The folder's name is a hash of all the engine's sources, a file's name one of all else that the
code depends on, and a file begins with the SHA-256 of its content.  An object that cannot be loaded
is compiled anew; one that cannot be kept is used all the same.

Loading a file runs what is in it.  So only files and folders are used that nobody but this user
can have written (`_distrust`, `_read`).
"""

import contextlib
import functools
import hashlib
import os
import stat
import sys
import tempfile
import time
import uuid
from pathlib import Path

import llvmlite

from .machine_code import processor

CHECKSUM = hashlib.sha256().digest_size
#: from how many seconds on it is reported how long code took to make
LONG = 1.0
_seconds: list = []  # of each code that was made and kept, until they are reported
_reported: list = []  # what was


def _digest():
    """A hash of all sources of machine code: the packages engine and friction, whole."""
    package = Path(__file__).parent.parent
    folders = package / "engine", package / "friction"
    paths = sorted(path for folder in folders for path in folder.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


DIGEST = _digest()


def obtained(name, make):
    """Machine code of this name, bytes: that which is kept, else what `make` gives, which is kept.

    A file that is damaged, or another user may have written, is reported on stderr; one that
    cannot be read is passed over.  It is told which folders do not take it.
    """
    file = f"{name}-{_machine()}.o"
    for folder in _folders():
        if (content := _read(folder / file)) is None:
            continue
        checksum, code = content[:CHECKSUM], content[CHECKSUM:]
        if hashlib.sha256(code).digest() == checksum:
            return code
        say(f"the machine code {folder / file} is damaged; it is compiled anew")
    return made(name, make)


def made(name, make):
    """Machine code of this name that `make` gives; it is kept."""
    start = time.perf_counter()
    code = make()
    seconds = time.perf_counter() - start
    if _keep(f"{name}-{_machine()}.o", hashlib.sha256(code).digest() + code):
        _seconds.append(seconds)
    return code


def report_time():
    """Say, once in this process, how long it took to make code since the last call."""
    seconds = sum(_seconds)
    _seconds.clear()
    if seconds >= LONG and not _reported:
        _reported.append(seconds)
        report(f"compiled the solver for this machine in {seconds:.1f} s; it is kept")


def _keep(file, content):
    """Write a file into the first folder that takes it; whether one does."""
    refusals = []
    for folder in _folders():
        try:
            for part in (*reversed(folder.parents), folder):
                with contextlib.suppress(FileExistsError, IsADirectoryError):
                    part.mkdir(mode=0o700)
            _write(folder / file, content)
        except OSError as error:
            refusals.append(f"{folder} ({error.strerror or error})")
            continue
        if refusals:
            say(f"machine code cannot be kept in {refusals[0]}; it is in {folder}")
        return True
    say(
        f"machine code cannot be kept in {' nor in '.join(refusals) or 'any folder'}: each "
        f"process compiles its own; make room, or set XDG_CACHE_HOME to a folder that can be "
        f"written to"
    )
    return False


@functools.cache
def _machine():
    """The part of a file's name that stands for the processor and for what made the code."""
    return short_hash((*processor(), llvmlite.__version__))


def short_hash(value):
    """A hash of what a value is written as."""
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]


def _folders():
    """Where kernels are kept: with the user's caches or, if they take none, a temporary folder.

    A folder that others may have put code into is left out, which is said on stderr.
    """
    base = os.environ.get("XDG_CACHE_HOME")
    name, found = f"kernels-{DIGEST}", []
    with contextlib.suppress(RuntimeError):  # no home
        found.append(Path(base or Path.home() / ".cache").resolve() / "ratestate" / name)
    with contextlib.suppress(FileNotFoundError):  # no folder for temporary files
        temporary = Path(tempfile.gettempdir()).resolve()
        found.append(temporary / f"ratestate-{os.geteuid()}" / name)
    reasons = {folder: _distrust(folder) for folder in found}
    for folder, reason in reasons.items():
        if reason:
            say(f"machine code in {folder.parent} is not used: {reason}")
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
        say(f"the machine code {path} may be another user's; it is compiled anew")
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
