"""Machine code: LLVM text is compiled into an object, which is kept on disk, and loaded.

The folder's name is a hash of the sources of engine and friction, a file's name one of all else
that the code depends on, and a file begins with the SHA-256 of its content.  An object that cannot
be loaded is compiled anew; one that cannot be kept is used all the same.

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
import llvmlite.binding as llvm

from ..errors import CompilationError

#: objects that are loaded: their code stays as long as these are referred to
_LOADED: list = []
#: LLVM's names of processors that lower their clock where they use their widest vectors
THROTTLED = "skylake", "cannonlake", "cascadelake", "cooperlake"
CHECKSUM = hashlib.sha256().digest_size
#: from how many seconds on it is reported how long code took to make
LONG = 1.0
_seconds: list = []  # of each code that was made and kept, until they are reported
_reported: list = []  # what was


# Compiled and loaded


@functools.cache
def _initialized(triple):
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(triple)


def processor():
    """LLVM's names of this machine, its kind of processor, and the features that code may use."""
    features = llvm.get_host_cpu_features().flatten()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), features


def doubles_of_vector():
    """How many doubles the vectors have in which this processor is fastest."""
    features, processor = llvm.get_host_cpu_features(), llvm.get_host_cpu_name()
    if features.get("avx512f") and not processor.startswith(THROTTLED):
        return 8
    return 4 if features.get("avx") else 2


def target(cpu=None, features=None, triple=None):
    """The machine for which code is made: this one, or one of this kind of processor."""
    here, own, native = processor()
    return _initialized(triple or here).create_target_machine(
        cpu=cpu or own,
        features=native if features is None else features,
        opt=3,
        reloc="pic",
        codemodel="small",
    )


def optimized(text, machine, level):
    """Return LLVM text as a module for a machine; level : of optimisation."""
    layout = f'target datalayout = "{machine.target_data}"\ntarget triple = "{machine.triple}"\n'
    module = llvm.parse_assembly(layout + text)
    module.verify()
    if level > 0:
        options = llvm.create_pipeline_tuning_options(speed_level=level)
        options.loop_vectorization = options.slp_vectorization = False
        passes = llvm.create_pass_builder(machine, options)
        passes.getModulePassManager().run(module, passes)
    return module


def compiled(text, machine=None, level=0):
    """The object, bytes, of LLVM text.

    level : of optimisation; straight lines of code, which say each thing once, need none
    """
    machine = machine or target()
    return machine.emit_object(optimized(text, machine, level))


def loaded(code, names):
    """Addresses (dict name -> int) of functions in an object; ImportError where one is missing."""
    # (the engine owns the machine that it is given)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    found = {name: engine.get_function_address(name) for name in names}
    if missing := [name for name, address in found.items() if address == 0]:
        raise ImportError(f"compiled code lacks {', '.join(missing)}")
    _LOADED.append(engine)
    return found


def addresses(name, make, functions):
    """Addresses of functions in machine code of this name, which is kept, else made.

    Code that is kept and cannot be loaded is made anew.  CompilationError if that fails too.
    """
    try:
        with contextlib.suppress(ImportError):
            return loaded(obtained(name, make), functions)
        return loaded(made(name, make), functions)
    except CompilationError:  # of a law
        raise
    except Exception as error:  # none of a case's: machine code has but status codes
        raise CompilationError(
            f"the solver cannot be compiled on this machine ({reason(error)}). No parameter is "
            f"at fault: free memory, or install ratestate and llvmlite anew, and run the same "
            f"again."
        ) from error


def reason(error):
    """The kind of an error, and its first line."""
    return f"{type(error).__name__}: {error}".splitlines()[0]


# Kept on disk


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
        say(f"compiled the solver for this machine in {seconds:.1f} s; it is kept")


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
    """Write a line on stderr, once in this process; nothing where there is no stderr."""
    if sys.stderr:
        sys.stderr.write(f"ratestate: {text}\n")
        sys.stderr.flush()
