"""Compiled kernels on disk: damaged, full, refused, another's; a call never fails for it."""

import errno
import hashlib
import os
import pickle
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

import ratestate as rs
from ratestate.engine import cache, dispatch, jit
from ratestate.engine.march import march
from ratestate.errors import CompilationError
from ratestate.friction.composition import under_varying_stress
from ratestate.friction.laws import LAWS

CHECKSUM = hashlib.sha256().digest_size


def add_three(x):
    return x + 3.0


@pytest.fixture
def usual(tmp_path, monkeypatch):
    """The folder for kernels, in an empty cache; temporary files have a folder of their own too."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "tmp"))
    cache.say.cache_clear()
    return tmp_path / "cache" / "ratestate" / f"kernels-{cache.DIGEST}"


@pytest.fixture
def temporary(tmp_path, usual):
    return tmp_path / "tmp" / f"ratestate-{os.geteuid()}" / f"kernels-{cache.DIGEST}"


def called():
    """Call the function, as a new process would; whether it was found compiled."""
    found, compiled = [], jit.kernel(add_three)
    load = compiled._cache.load_overload
    compiled._cache.load_overload = lambda *a: found.append(load(*a)) or found[-1]
    assert compiled(4.5) == 7.5
    return [one is not None for one in found] == [True]


def only(folder):
    """The one file of a kernel in a folder."""
    (path,) = folder.iterdir()
    assert path.name.startswith("test_kernel_cache.add_three-")
    assert path.suffix == ".nbc"
    return path


def test_a_kernel_is_compiled_once(usual, temporary, capfd):
    assert [called(), called(), called()] == [False, True, True]
    content = only(usual).read_bytes()
    assert content[:CHECKSUM] == hashlib.sha256(content[CHECKSUM:]).digest()
    assert not temporary.exists()
    assert capfd.readouterr().err == ""


def test_one_file_for_types_and_programs(usual, monkeypatch):
    called()
    integer = jit.kernel(add_three)
    assert integer(4) == 7.0
    assert len(list(usual.iterdir())) == 2
    monkeypatch.setattr(cache, "PROGRAMS", ("another numba",))
    assert [called(), called()] == [False, True]
    assert len(list(usual.iterdir())) == 3


def test_kernels_are_of_their_sources(tmp_path, monkeypatch):
    """A change of any file of the engine or of friction, or a new one, has other kernels."""
    package = Path(cache.__file__).parents[1]
    sources = [
        path for folder in ("engine", "friction") for path in (package / folder).rglob("*.py")
    ]
    for path in sources:
        copy = tmp_path / path.relative_to(package)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, copy)
    monkeypatch.setattr(cache, "__file__", str(tmp_path / "engine" / "cache.py"))
    assert cache._digest() == cache.DIGEST
    for path in sorted(tmp_path.rglob("*.py")):
        content = path.read_bytes()
        path.write_bytes(content + b"\n")
        assert cache._digest() != cache.DIGEST, path
        path.write_bytes(content)
    (tmp_path / "friction" / "laws" / "another.py").write_text("# a law\n")
    assert cache._digest() != cache.DIGEST


def signed(content):
    return hashlib.sha256(content).digest() + content


def flipped(content, place):
    changed = bytearray(content)
    changed[int(place * (len(content) - 1))] ^= 1
    return bytes(changed)


DAMAGES = {
    "cut": lambda content: content[:1000],
    "empty": lambda content: b"",
    "noise": lambda content: np.random.default_rng(1).bytes(3000),
    **{f"bit at {x}": lambda content, x=x: flipped(content, x) for x in (0, 0.01, 0.3, 0.7, 1)},
    "no pickle": lambda content: signed(b"\x1b" * 3000),
    "another thing": lambda content: signed(pickle.dumps({"a": 1})),
    "too few": lambda content: signed(pickle.dumps(pickle.loads(content[CHECKSUM:])[:1])),
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_is_replaced(damage, usual, capfd):
    called()
    path = only(usual)
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    assert not called()
    said = f"ratestate: the compiled kernel {path} is damaged; it is compiled anew\n"
    assert capfd.readouterr().err == said
    assert only(usual) == path
    content = path.read_bytes()
    assert content[:CHECKSUM] == hashlib.sha256(content[CHECKSUM:]).digest()
    assert len(content) > 0.9 * len(whole)
    assert called()
    assert capfd.readouterr().err == ""


def test_a_flipped_bit_of_real_machine_code(tmp_path):
    program = (
        "import numpy as np; from ratestate.engine.noise import whiten; out = np.empty((3, 1));"
        "print(whiten(np.ones(2), 1.0, np.ones(1), np.ones(1), np.ones((3, 1)), out), out)"
    )

    def run():
        place = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
        command = [sys.executable, "-c", program]
        return subprocess.run(command, env=place, capture_output=True, text=True, check=False)

    first = run()
    assert (first.returncode, first.stderr) == (0, "")
    t = np.arange(3.0)
    log_determinant = np.linalg.slogdet(np.eye(3) + np.exp(-abs(t - t[:, None])))[1]
    assert float(first.stdout.split()[0]) == pytest.approx(log_determinant, rel=1e-14)
    (path,) = tmp_path.rglob("*.nbc")
    assert path.is_relative_to(tmp_path / "ratestate" / f"kernels-{cache.DIGEST}")
    content = path.read_bytes()
    at = content.index(b"\x7fELF")  # the object file begins; behind its header there is code
    start, end = at + 64, at + 400
    path.write_bytes(content[:start] + bytes(b ^ 1 for b in content[start:end]) + content[end:])
    second, third = run(), run()
    assert second.stdout == third.stdout == first.stdout
    assert second.stderr.count("is damaged") == 1
    assert (second.returncode, third.returncode, third.stderr) == (0, 0, "")


# ------------------------------------------------------------------------------- nowhere to put it


def refuse(monkeypatch, *folders):
    """Let writes into some folders find the disk full."""
    write = cache._write

    def full(path, content):
        if path.parent in folders:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(path, content)

    monkeypatch.setattr(cache, "_write", full)


def test_a_full_disk_leads_to_one_folder_of_this_user(usual, temporary, monkeypatch, capfd):
    refuse(monkeypatch, usual)
    assert [called(), called(), called()] == [False, True, True]
    only(temporary)
    assert stat.S_IMODE(temporary.parent.stat().st_mode) == 0o700
    assert capfd.readouterr().err == (
        f"ratestate: compiled kernels cannot be kept in {usual} (No space left on device); "
        f"they are in {temporary}\n"
    )


def test_a_folder_that_cannot_be_made(usual, temporary, tmp_path, capfd):
    (tmp_path / "cache").write_text("a file")
    assert [called(), called()] == [False, True]
    only(temporary)
    said = capfd.readouterr().err
    assert f"cannot be kept in {usual} (Not a directory); they are in {temporary}" in said


def test_no_place_at_all(usual, temporary, monkeypatch, capfd):
    refuse(monkeypatch, usual, temporary)
    assert [called(), called()] == [False, False]
    said = capfd.readouterr().err
    assert said.count("\n") == 1  # once
    assert f"{usual} (No space left on device) nor in {temporary} (No space" in said
    assert "XDG_CACHE_HOME" in said


def test_a_disk_that_fills_up_leaves_no_part_of_a_file(usual, temporary):
    from limits import largest_file

    with largest_file(5000):
        assert not called()
    assert [*usual.iterdir(), *temporary.iterdir()] == []


def test_no_home_and_no_temporary_folder(monkeypatch, usual):
    monkeypatch.delenv("XDG_CACHE_HOME")

    def missing():
        raise RuntimeError("Could not determine home directory.")

    def none():
        raise FileNotFoundError("No usable temporary directory found")

    monkeypatch.setattr("pathlib.Path.home", missing)
    monkeypatch.setattr("tempfile.gettempdir", none)
    assert [called(), called()] == [False, False]


# ---------------------------------------------------------------------------- code of other users


def disowned(path):
    if os.geteuid() != 0:
        pytest.skip("only root can give a file away")
    os.chown(path, 65534, -1)


def linked(path):
    path.rename(path.with_name("else"))
    path.symlink_to("else")


OWN = {
    "the group may write": (lambda path: path.chmod(0o720), "other users may write to"),
    "others may write": (lambda path: path.chmod(0o702), "other users may write to"),
    "others may write, sticky": (lambda path: path.chmod(0o1702), "other users may write to"),
    "another's": (disowned, "belongs to another user"),
    "a link": (linked, "is a link or a file"),
}
ABOVE = {
    "others may write": (lambda path: path.chmod(0o707), "chmod o-w"),
    "another's": (disowned, "belongs to another user"),
}


@pytest.mark.parametrize(
    ("level", "change", "reason"),
    [(0, *one) for one in OWN.values()]
    + [(1, *one) for one in OWN.values()]
    + [(2, *one) for one in ABOVE.values()],
    ids=[*OWN, *(f"{k}, around it" for k in OWN), *(f"{k}, above" for k in ABOVE)],
)
def test_a_folder_of_others_is_passed_over(level, change, reason, usual, temporary, capfd):
    """Be it the folder itself, the one around it, or one above; the two places are alike."""
    for folder in (usual, temporary):
        for part in (*reversed(folder.parents), folder):
            part.mkdir(mode=0o700, exist_ok=True)
        assert folder in cache._folders()
        changed = (folder, *folder.parents)[level]
        change(changed)
        assert folder not in cache._folders()
        said = capfd.readouterr().err
        assert said.startswith(f"ratestate: compiled kernels in {folder.parent} are not used: ")
        assert f"{changed}" in said
        assert reason in said
        assert said.count("\n") == 1  # once


def test_folders_that_are_safe_are_used(usual, temporary, capfd):
    """Others may write above them under the sticky bit, or the group; and above there are links."""
    assert cache._folders() == [usual, temporary]  # where there is nothing yet
    cache_home = usual.parents[1]
    cache_home.mkdir()
    for mode in (0o1777, 0o775, 0o755, 0o700):
        cache_home.chmod(mode)
        assert cache._folders() == [usual, temporary], oct(mode)
    linked(cache_home)
    elsewhere = cache_home.with_name("else") / "ratestate" / usual.name
    assert cache._folders() == [elsewhere, temporary]
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("safe", [True, False])
def test_code_of_others_does_not_run(safe, usual, temporary, tmp_path):
    """A file that is made up as a kernel runs what it likes, from a safe folder alone."""
    called()
    path = only(usual)
    payload = pickle.dumps(Payload(str(tmp_path / "ran")))
    path.write_bytes(hashlib.sha256(payload).digest() + payload)
    usual.parent.chmod(0o700 if safe else 0o707)
    assert not called()
    assert (tmp_path / "ran").exists() == safe
    assert temporary.exists() != safe


class Payload(tuple):
    """Makes a folder when it is unpickled."""

    def __new__(cls, path):
        return super().__new__(cls, (path,))

    def __reduce__(self):
        return os.mkdir, tuple(self)


@pytest.mark.parametrize("mask", [0, 0o002, 0o022, 0o077])
def test_folders_and_files_are_this_users_alone(mask, usual, capfd):
    before = os.umask(mask)
    try:
        assert [called(), called()] == [False, True]
    finally:
        os.umask(before)
    for folder in (usual, *usual.parents[:2]):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert stat.S_IMODE(only(usual).stat().st_mode) == 0o600
    assert capfd.readouterr().err == ""


def replaced(make):
    def replace(path):
        content = path.read_bytes()
        path.unlink()
        make(path, content)

    return replace


def link_to_a_copy(path, content):
    path.with_name("copy").write_bytes(content)
    path.symlink_to("copy")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda path: path.chmod(0o620), True),
        (lambda path: path.chmod(0o602), True),
        (disowned, True),
        (replaced(lambda path, _: os.mkfifo(path, 0o600)), True),
        (replaced(link_to_a_copy), False),
        (replaced(lambda path, _: path.mkdir()), False),
    ],
    ids=["group", "others", "owner", "FIFO", "link", "folder"],
)
def test_a_file_of_others_is_not_loaded(change, told, usual, capfd):
    called()
    path = only(usual)
    change(path)
    assert not called()
    said = f"the compiled kernel {path} may be another user's; it is compiled anew"
    assert (said in capfd.readouterr().err) == told
    if path.is_file():
        assert called()


def test_writers_at_once_leave_a_whole_file(usual):
    program = (
        "import sys; from pathlib import Path; from ratestate.engine import cache\n"
        "path, content = Path(sys.argv[1]), bytes([int(sys.argv[2])]) * 300_000\n"
        "for _ in range(40): cache._write(path, content)"
    )
    usual.mkdir(parents=True)
    path = usual / "x.nbc"
    cache._write(path, bytes(300_000))
    command = [sys.executable, "-c", program, str(path)]
    writers = [subprocess.Popen([*command, str(i)]) for i in (1, 2)]
    while any(writer.poll() is None for writer in writers):
        content = path.read_bytes()
        assert content == content[:1] * 300_000
    assert [writer.returncode for writer in writers] == [0, 0]
    assert list(usual.iterdir()) == [path]


# ------------------------------------------------------------------------- compiling itself fails


def test_a_kernel_that_cannot_be_compiled(monkeypatch):
    @jit.kernel
    def broken(x, budget):
        return x.nothing

    worker = dispatch._Worker(broken, (), LAWS["slip"], False, np.zeros(1), ())
    worker.arguments = (1.0,)
    with pytest.raises(CompilationError, match=r"the solver cannot be compiled.*TypingError"):
        worker.go()


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="the compiler is off")
@pytest.mark.parametrize(
    "slider",
    [
        {"law": "slip", "damping": 1e4},
        {"law": "slip", "friction": "regularized", "damping": 1e4},
        {
            "law": "two-state-aging",
            "b2": 0.001,
            "Dc2": 5e-5,
            "friction": "cut-off",
            "V1": 1,
            "V2": 1,
        },
    ],
)
def test_kernels_of_all_that_a_slider_is_made_of_are_kept(slider):
    """Not so a function that was handed to another in compiled code: it has an address."""
    made = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3e3, **slider)
    rs.simulate(made, rs.Loading.constant(1e-4).sigma_step(1e-3, 2.1e6), 2e-3)
    assert march._cache.kept(under_varying_stress(made.friction_law))
