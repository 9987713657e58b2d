"""Machine code: LLVM text is compiled into an object, cached on disk, and loaded.

The name of the cache folder is a hash of the sources of engine and friction.  The name of a file is
a hash of everything else that the code depends on.  A file begins with the SHA-256 of its content.
An object that cannot be loaded is compiled again; an object that cannot be cached is used anyway.

Loading a file runs its code.  So only files and folders are used that no other user can have
written (`_reason_for_distrust`, `_read`).
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
from ..friction.user_law import reason_of

#: engines of the loaded objects, whose code exists as long as the engines do
_LOADED: list = []
#: LLVM's names of processors that lower their clock when they use their widest vectors
THROTTLED = "skylake", "cannonlake", "cascadelake", "cooperlake"
CHECKSUM = hashlib.sha256().digest_size
#: shortest time to make code that is reported [s]
REPORTED_SECONDS = 1.0
_seconds: list = []  # for each code that was made and cached, until they are reported
_reported: list = []  # seconds that were reported


# Compile and load


@functools.cache
def _initialized(triple):
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(triple)


def processor():
    """Return LLVM's names of this machine, its processor, and the features to use."""
    features = llvm.get_host_cpu_features().flatten()
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), features


def doubles_of_vector():
    """Return the number of doubles in the vectors that are fastest on this processor."""
    features, processor = llvm.get_host_cpu_features(), llvm.get_host_cpu_name()
    if features.get("avx512f") and not processor.startswith(THROTTLED):
        return 8
    return 4 if features.get("avx") else 2


def target(cpu=None, features=None, triple=None):
    """Return the machine to compile for: this one, or one with another processor."""
    this_triple, name, native = processor()
    return _initialized(triple or this_triple).create_target_machine(
        cpu=cpu or name,
        features=native if features is None else features,
        opt=3,
        reloc="pic",
        codemodel="small",
    )


def optimize(text, machine, level):
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


def compile_object(text, machine=None, level=0):
    """Compile LLVM text into an object, bytes.

    level : of optimisation; units need none, because they have no branches and no repeated work
    """
    machine = machine or target()
    return machine.emit_object(optimize(text, machine, level))


def load_functions(code, names):
    """Load an object, return its functions' addresses; ImportError if one is missing."""
    # The engine takes ownership of the machine, so each one gets a new one.  `use_lmm` puts code
    # and constants side by side.  Else they may lie more than 2 GiB apart in a process that uses
    # much address space, as one with a GPU does, and LLVM would abort the process.
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target(), use_lmm=True)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    addresses = {name: engine.get_function_address(name) for name in names}
    if missing := [name for name, address in addresses.items() if address == 0]:
        raise ImportError(f"compiled code lacks {', '.join(missing)}")
    _LOADED.append(engine)
    return addresses


def addresses(name, make, functions):
    """Return the addresses of functions in cached machine code, or make the code.

    If cached code cannot be loaded, the code is made again.  CompilationError if that fails too.
    """
    try:
        with contextlib.suppress(ImportError):
            return load_functions(cached_code(name, make), functions)
        return load_functions(make_and_cache(name, make), functions)
    except CompilationError:  # due to a law
        raise
    except Exception as error:  # not due to a case: machine code has status codes, no exceptions
        raise CompilationError(
            f"the solver cannot be compiled on this machine ({reason_of(error)}). No parameter is "
            f"at fault: free memory, or install ratestate and llvmlite anew, and run the same "
            f"again."
        ) from error


# Cache on disk


def _digest():
    """Return a hash of all sources of machine code: the packages engine and friction."""
    package = Path(__file__).parent.parent
    folders = package / "engine", package / "friction"
    paths = sorted(path for folder in folders for path in folder.rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]


DIGEST = _digest()


def cached_code(name, make):
    """Return machine code, bytes, from the cache, or make and cache it.

    A damaged file, or one that another user may have written, is reported on stderr.  An unreadable
    file is ignored.  Folders that cannot take the code are reported.
    """
    file = f"{name}-{_machine()}.o"
    for folder in _folders():
        if (content := _read(folder / file)) is None:
            continue
        checksum, code = content[:CHECKSUM], content[CHECKSUM:]
        if hashlib.sha256(code).digest() == checksum:
            return code
        report_once(f"the machine code {folder / file} is damaged, so it is compiled again")
    return make_and_cache(name, make)


def make_and_cache(name, make):
    """Make machine code of this name by `make`, and cache it."""
    start = time.perf_counter()
    code = make()
    seconds = time.perf_counter() - start
    if _cache(f"{name}-{_machine()}.o", hashlib.sha256(code).digest() + code):
        _seconds.append(seconds)
    return code


def report_time(law):
    """Report, once in a process, how long it took to make a law's code since the last call."""
    seconds = sum(_seconds)
    _seconds.clear()
    if seconds >= REPORTED_SECONDS and not _reported:
        _reported.append(seconds)
        report_once(f"compiled the solver for the {law} in {seconds:.1f} s, and kept it")


def _cache(file, content):
    """Write a file into the first folder that takes it; return whether one does."""
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
            report_once(f"machine code cannot be kept in {refusals[0]}, so it is in {folder}")
        return True
    report_once(
        f"machine code cannot be kept in {' nor in '.join(refusals) or 'any folder'}: each "
        f"process compiles its own. Make room, or set XDG_CACHE_HOME to a folder that can be "
        f"written to"
    )
    return False


@functools.cache
def _machine():
    """Return the part of a file's name for the processor and the version of llvmlite."""
    return short_hash((*processor(), llvmlite.__version__))


def short_hash(value):
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]


def _folders():
    """Return the cache folders: in the user's cache, then in the temporary folder.

    A folder that others may have put code into is left out, with a report on stderr.
    """
    base = os.environ.get("XDG_CACHE_HOME")
    name, folders = f"kernels-{DIGEST}", []
    with contextlib.suppress(RuntimeError):  # no home
        folders.append(Path(base or Path.home() / ".cache").resolve() / "ratestate" / name)
    with contextlib.suppress(FileNotFoundError):  # no folder for temporary files
        temporary = Path(tempfile.gettempdir()).resolve()
        folders.append(temporary / f"ratestate-{os.geteuid()}" / name)
    reasons = {folder: _reason_for_distrust(folder) for folder in folders}
    for folder, reason in reasons.items():
        if reason:
            report_once(f"machine code in {folder.parent} is not used: {reason}")
    return [folder for folder, reason in reasons.items() if not reason]


def _reason_for_distrust(kernels):
    """Return why another user may have put code into a folder; "" if nobody can have.

    The folder and its parent, ratestate's own folder, must belong to this user, and nobody else may
    write to them.  The folders above must belong to this user or to root.  If anybody may write to
    them, they need the sticky bit, under which users cannot replace each other's files.

    kernels : Path without links above ratestate's own folder
    """
    cache, user = kernels.parent, os.geteuid()
    for folder in (kernels, *kernels.parents):
        try:
            status = folder.lstat()
        except OSError:  # the folder does not exist
            continue
        inside = folder in (kernels, cache)
        if status.st_uid != user and (inside or status.st_uid != 0):
            return f"{folder} belongs to another user. Set XDG_CACHE_HOME to a folder of your own."
        if inside and not stat.S_ISDIR(status.st_mode):
            return f"{folder} is a link or a file. Remove it."
        if inside and status.st_mode & 0o022:
            return f"other users may write to {folder}. Run: chmod -R go-w {cache}"
        if status.st_mode & stat.S_IWOTH and not status.st_mode & stat.S_ISVTX:
            return f"other users may write to {folder}. Run: chmod o-w {folder}"
    return ""


def _read(path):
    """Return the bytes of a file that only this user can have written, else None."""
    with contextlib.suppress(OSError):  # most often the file does not exist
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(handle, "rb") as file:
            status = os.fstat(handle)
            is_trusted = status.st_uid == os.geteuid() and not status.st_mode & 0o022
            if is_trusted and stat.S_ISREG(status.st_mode):
                return file.read()
        report_once(f"the machine code {path} may be another user's, so it is compiled again")
    return None


def _write(path, content):
    """Write a file so that it is whole or absent, even if others write it at once."""
    partial = path.with_name(f".{path.name}.{uuid.uuid4().hex}.partial")
    try:
        partial.touch(mode=0o600)  # under any umask, because `_read` checks the mode
        partial.write_bytes(content)
        partial.replace(path)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()


@functools.cache
def report_once(text):
    """Write a line to stderr, if there is one, once in this process."""
    if sys.stderr:
        sys.stderr.write(f"ratestate: {text}\n")
        sys.stderr.flush()
