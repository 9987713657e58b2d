"""The cache of machine code: damaged, full, refused or another's; no call fails."""

import ctypes
import hashlib
import os
import shutil
import stat
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from limits import largest_file

from ratestate.engine import machine_code, programs
from ratestate.engine.units import ReturnUnits
from ratestate.errors import CompilationError
from ratestate.friction.laws import LAWS

CHECKSUM = hashlib.sha256().digest_size


TEXT = "define i64 @add_three(i64 %x) {{ %y = add i64 %x, {number}\nret i64 %y }}"


@pytest.fixture
def cache_folder(tmp_path, monkeypatch):
    """The folder for code in an empty cache; temporary files have another folder."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    machine_code.report_once.cache_clear()
    return tmp_path / "cache" / "ratestate" / f"kernels-{machine_code.DIGEST}"


@pytest.fixture
def other_folder(tmp_path, cache_folder):
    return tmp_path / "tmp" / f"ratestate-{os.geteuid()}" / f"kernels-{machine_code.DIGEST}"


def load_add_three(number=3):
    """Load code that adds 3, as a new process would; return whether it was cached."""
    made = []

    def make():
        made.append(True)
        return machine_code.compile_object(TEXT.format(number=number))

    code = machine_code.cached_code("add_three", make)
    add = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64)
    assert add(machine_code.load_functions(code, ["add_three"])["add_three"])(4) == 4 + number
    return not made


def only_file(folder):
    """Return the one file in a folder, which is whole."""
    (path,) = folder.iterdir()
    assert path.name == f"add_three-{machine_code._machine()}.o"
    content = path.read_bytes()
    assert content[:CHECKSUM] == hashlib.sha256(content[CHECKSUM:]).digest()
    return path


def test_code_is_compiled_once(cache_folder, other_folder, capfd):
    assert [load_add_three(), load_add_three(), load_add_three()] == [False, True, True]
    only_file(cache_folder)
    assert not other_folder.exists()
    assert capfd.readouterr().err == ""


def test_one_file_for_each_processor_and_compiler(cache_folder, monkeypatch):
    assert not load_add_three()
    names, (triple, *_) = {only_file(cache_folder).name}, machine_code.processor()
    for module, name, value in (
        (machine_code, "processor", lambda: (triple, "generic", "")),
        (machine_code.llvmlite, "__version__", "0.0"),
    ):
        monkeypatch.setattr(module, name, value)
        machine_code._machine.cache_clear()
        names.add(f"add_three-{machine_code._machine()}.o")
        assert [load_add_three(), load_add_three()] == [False, True]
    machine_code._machine.cache_clear()
    assert {path.name for path in cache_folder.iterdir()} == names
    assert len(names) == 3


def test_cache_folder_depends_on_all_sources(tmp_path, monkeypatch):
    """A change of any file of the engine or of friction, or a new one, has another folder."""
    package = Path(machine_code.__file__).parents[1]
    sources = [
        path for folder in ("engine", "friction") for path in (package / folder).rglob("*.py")
    ]
    for path in sources:
        copy = tmp_path / path.relative_to(package)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, copy)
    monkeypatch.setattr(machine_code, "__file__", str(tmp_path / "engine" / "machine_code.py"))
    assert machine_code._digest() == machine_code.DIGEST
    for path in sorted(tmp_path.rglob("*.py")):
        content = path.read_bytes()
        path.write_bytes(content + b"\n")
        assert machine_code._digest() != machine_code.DIGEST, path
        path.write_bytes(content)
    (tmp_path / "friction" / "another.py").write_text("# a law\n")
    assert machine_code._digest() != machine_code.DIGEST


def flipped(place):
    """Return a function that changes a bit at a fraction of the content."""

    def damage(content):
        changed = bytearray(content)
        changed[int(place * (len(content) - 1))] ^= 1
        return bytes(changed)

    return damage


@pytest.mark.parametrize(
    "damage",
    [lambda content: content[:300], lambda _: b"", *map(flipped, (0, 0.01, 0.3, 1))],
    ids=["cut", "empty", *(f"bit at {place}" for place in (0, 0.01, 0.3, 1))],
)
def test_a_damaged_file_is_replaced(damage, cache_folder, capfd):
    load_add_three()
    path = only_file(cache_folder)
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    assert not load_add_three()
    message = f"ratestate: the machine code {path} is damaged, so it is compiled again\n"
    assert capfd.readouterr().err == message
    assert only_file(cache_folder).read_bytes() == whole
    assert load_add_three()
    assert capfd.readouterr().err == ""


def test_a_process_that_is_killed_while_it_writes(cache_folder, tmp_path):
    """What it leaves is not taken for code."""
    stops = (
        "import os, pathlib, time; from ratestate.engine import machine_code;"
        "os.replace = pathlib.Path.replace = lambda *given: (print(flush=True), time.sleep(60));"
        "machine_code.cached_code('add_three', lambda: bytes(300_000))"
    )
    place = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    command = [sys.executable, "-c", stops]
    with subprocess.Popen(command, env=place, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        process.kill()
    (partial,) = cache_folder.iterdir()
    assert partial.suffix == ".partial"
    assert [load_add_three(), load_add_three()] == [False, True]


# ------------------------------------------------------------------------------- nowhere to put it


def test_a_folder_that_cannot_be_made(cache_folder, other_folder, tmp_path, capfd):
    (tmp_path / "cache").write_text("a file")
    assert [load_add_three(), load_add_three(), load_add_three()] == [False, True, True]
    only_file(other_folder)
    assert stat.S_IMODE(other_folder.parent.stat().st_mode) == 0o700
    assert capfd.readouterr().err == (
        f"ratestate: machine code cannot be kept in {cache_folder} (Not a directory), "
        f"so it is in {other_folder}\n"
    )


def test_a_full_disk(cache_folder, other_folder, capsys):
    """Code runs that cannot be kept, and no part of a file is left."""
    with largest_file(100):
        assert [load_add_three(), load_add_three()] == [False, False]
    assert [*cache_folder.iterdir(), *other_folder.iterdir()] == []
    message = capsys.readouterr().err
    assert message.count("\n") == 1  # once
    assert f"{cache_folder} (File too large) nor in {other_folder} (File too large)" in message
    assert "XDG_CACHE_HOME" in message


def raise_error(kind, *_):
    raise kind("no number")


def test_no_home_and_no_temporary_folder(monkeypatch, cache_folder):
    monkeypatch.delenv("XDG_CACHE_HOME")

    monkeypatch.setattr("pathlib.Path.home", partial(raise_error, RuntimeError))
    monkeypatch.setattr("tempfile.gettempdir", partial(raise_error, FileNotFoundError))
    assert [load_add_three(), load_add_three()] == [False, False]


# ---------------------------------------------------------------------------- code of other users


def disowned(path):
    if os.geteuid() != 0:
        pytest.skip("only root can give a file away")
    os.chown(path, 65534, -1)


def linked(path):
    path.rename(path.with_name("else"))
    path.symlink_to("else")


def mode(bits):
    return lambda path: path.chmod(bits)


@pytest.mark.parametrize(
    ("level", "change", "reason"),
    [
        (0, mode(0o720), "other users may write to"),
        (0, mode(0o1702), "other users may write to"),
        (0, disowned, "belongs to another user"),
        (0, linked, "is a link or a file"),
        (1, mode(0o702), "other users may write to"),
        (1, disowned, "belongs to another user"),
        (1, linked, "is a link or a file"),
        (2, mode(0o707), "chmod o-w"),
        (2, disowned, "belongs to another user"),
    ],
)
def test_a_cache_folder_that_others_can_write_to_is_not_used(
    level, change, reason, cache_folder, other_folder, capfd
):
    """Be it the folder itself, the one around it, or one above; the two places are alike."""
    for folder in (cache_folder, other_folder):
        for part in (*reversed(folder.parents), folder):
            part.mkdir(mode=0o700, exist_ok=True)
        assert folder in machine_code._folders()
        changed = (folder, *folder.parents)[level]
        change(changed)
        assert folder not in machine_code._folders()
        message = capfd.readouterr().err
        assert message.startswith(f"ratestate: machine code in {folder.parent} is not used: ")
        assert f"{changed}" in message
        assert reason in message
        assert message.count("\n") == 1  # once


def test_folders_that_are_safe_are_used(cache_folder, other_folder, capfd):
    """Others may write above them under the sticky bit, or the group; and above there are links."""
    assert machine_code._folders() == [cache_folder, other_folder]  # where there is nothing yet
    cache_home = cache_folder.parents[1]
    cache_home.mkdir()
    for mode in (0o1777, 0o775, 0o755, 0o700):
        cache_home.chmod(mode)
        assert machine_code._folders() == [cache_folder, other_folder], oct(mode)
    linked(cache_home)
    elsewhere = cache_home.with_name("else") / "ratestate" / cache_folder.name
    assert machine_code._folders() == [elsewhere, other_folder]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("safe", [True, False])
def test_code_of_others_does_not_run(safe, cache_folder, other_folder):
    """A file that is made up as code runs what it likes, from a safe folder alone."""
    load_add_three()
    path, other = only_file(cache_folder), machine_code.compile_object(TEXT.format(number=5))
    path.write_bytes(hashlib.sha256(other).digest() + other)
    cache_folder.parent.chmod(0o700 if safe else 0o707)
    assert load_add_three(5 if safe else 3) == safe
    assert other_folder.exists() != safe


@pytest.mark.parametrize("mask", [0, 0o002, 0o022, 0o077])
def test_folders_and_files_are_this_users_alone(mask, cache_folder, capfd):
    before = os.umask(mask)
    try:
        assert [load_add_three(), load_add_three()] == [False, True]
    finally:
        os.umask(before)
    for folder in (cache_folder, *cache_folder.parents[:2]):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert stat.S_IMODE(only_file(cache_folder).stat().st_mode) == 0o600
    assert capfd.readouterr().err == ""


def fifo(path):
    path.unlink()
    os.mkfifo(path, 0o600)


def folder(path):
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        (mode(0o620), True),
        (mode(0o602), True),
        (disowned, True),
        (fifo, True),
        (linked, False),
        (folder, False),
    ],
)
def test_machine_code_of_another_user_is_not_loaded(change, reported, cache_folder, capfd):
    load_add_three()
    path = only_file(cache_folder)
    change(path)
    assert not load_add_three()
    message = f"the machine code {path} may be another user's, so it is compiled again"
    assert (message in capfd.readouterr().err) == reported
    if path.is_file():
        assert load_add_three()


def test_writers_at_once_leave_a_whole_file(cache_folder):
    program = (
        "import sys; from pathlib import Path; from ratestate.engine import machine_code\n"
        "path, content = Path(sys.argv[1]), bytes([int(sys.argv[2])]) * 300_000\n"
        "for _ in range(40): machine_code._write(path, content)"
    )
    cache_folder.mkdir(parents=True)
    path = cache_folder / "x.o"
    machine_code._write(path, bytes(300_000))
    command = [sys.executable, "-c", program, str(path)]
    writers = [subprocess.Popen([*command, str(i)]) for i in (1, 2)]
    while any(writer.poll() is None for writer in writers):
        content = path.read_bytes()
        assert content == content[:1] * 300_000
    assert [writer.returncode for writer in writers] == [0, 0]
    assert list(cache_folder.iterdir()) == [path]


# ------------------------------------------------------------------- what is loaded, and reported


def test_code_without_a_function_is_made_again(cache_folder):
    texts = iter(["define void @other() { ret void }", TEXT.format(number=3)])

    def make():
        return machine_code.compile_object(next(texts))

    assert machine_code.addresses("add_three", make, ["add_three"])["add_three"] > 0
    assert next(texts, None) is None
    assert load_add_three()  # it is kept


@pytest.mark.parametrize("text", ["define void @other() { ret void }", "define nothing"])
def test_code_that_fails_again_raises_an_error(text, cache_folder):
    make = partial(machine_code.compile_object, text)
    with pytest.raises(CompilationError, match=r"cannot be compiled on this machine \(\w+Error: "):
        machine_code.addresses("add_three", make, ["add_three"])


def test_a_law_that_cannot_be_compiled_is_named(cache_folder, monkeypatch):
    monkeypatch.setattr(programs, "unit_text", partial(raise_error, TypeError))
    with pytest.raises(CompilationError, match=r"the law slip .*\(TypeError: no number\)"):
        programs.units_of(type(LAWS["slip"])(), ReturnUnits, 4)


@pytest.mark.parametrize(("seconds", "reported"), [(0.6, "1.2"), (0.4, ""), (30.0, "60.0")])
def test_a_long_compilation_is_reported_once(seconds, reported, cache_folder, monkeypatch, capfd):
    monkeypatch.setattr(machine_code, "_reported", [])
    monkeypatch.setattr(machine_code, "_seconds", [])
    clock = iter(np.arange(100) * seconds)
    monkeypatch.setattr(time, "perf_counter", lambda: next(clock))
    for _ in range(3):
        for name in ("one", "other"):
            machine_code.make_and_cache(name, lambda: b"code")
        machine_code.report_time("slip law")
    message = f"ratestate: compiled the solver for the slip law in {reported} s, and kept it\n"
    assert capfd.readouterr().err == (message if reported else "")
