"""Stores of sweeps: what is put in comes out, and no accident takes it away."""

import contextlib
import fcntl
import itertools
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import zarr
from limits import largest_file
from paths import TESTS
from torture import SMALL, Here, same, torture

import ratestate as rs
from ratestate.errors import ParameterError, StoreError
from ratestate.files import read
from ratestate.sweeps import create as create_module
from ratestate.sweeps import store as store_module
from ratestate.sweeps import task, writing
from ratestate.sweeps.lock import exclusive_lock
from ratestate.sweeps.status import failures, store_status
from ratestate.sweeps.writing import NO_RESULT

POINT = {"a": 0.003, "b": 0.006, "Dc": "10 um", "sigma": "2 MPa", "K": "900 MPa/m"}
# 16 cases in 8 chunks: (M, V_lp) in blocks of (1, 2).
AXES = {"M": rs.logspace("M", 100, 1e4, 4), "V_lp": rs.logspace("V_lp", 1e-3, 1e-2, 4)}
CHUNKS, CHUNK = 8, 2
WHOLE = 16  # all cases in one chunk: where it does not matter, that is quick


def sweep(path=None, verb="stability", *, chunk=CHUNK, **changes):
    """Sweep with the parameters above, but for these."""
    values = POINT | AXES | changes
    own = {"V_lp", "rtol", "loading", "t_end", "times", "initial", "V_start", "mixed"}
    slider = rs.SpringSlider(**{k: v for k, v in values.items() if k not in own})
    arguments = {k: v for k, v in values.items() if k in own}
    if "loading" in arguments:
        del arguments["V_lp"]
    return rs.sweep(verb, slider, store=path, chunk=chunk, progress=False, **arguments)


def assert_same(one, other, names=None):
    """The variables of two results, coordinates too, are equal to the last bit."""
    assert set(one.variables) == set(other.variables)
    for name in names or one.variables:
        assert one[name].dims == other[name].dims, name
        assert same(one[name].values, other[name].values), name


def files(folder):
    """Path -> content of all files in a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def leftovers(folder):
    """What should not outlast a sweep."""
    return [path for path in folder.rglob("*") if "partial" in path.name]


@contextlib.contextmanager
def solved(before):
    """Within, `before(number of the call)` is called before each chunk is solved."""
    numbers = itertools.count()
    with pytest.MonkeyPatch.context() as patch:
        solve = task.solve

        def solving(*arguments):
            before(next(numbers))
            return solve(*arguments)

        patch.setattr(task, "solve", solving)
        yield


def interrupted(path, after=5, **asked):
    """A store whose sweep was interrupted after about so many chunks."""

    def interrupt(number):
        if number >= after:
            raise KeyboardInterrupt

    with solved(interrupt), pytest.raises(KeyboardInterrupt):
        sweep(path, **asked)
    return path


@pytest.fixture
def path(tmp_path):
    return tmp_path / "x.zarr"


@pytest.fixture(scope="module")
def pattern(tmp_path_factory):
    return interrupted(tmp_path_factory.mktemp("pattern") / "x.zarr")


@pytest.fixture
def begun(path, pattern):
    """A store of which some chunks are done."""
    shutil.copytree(pattern, path)
    return path


@pytest.fixture(scope="module")
def expected():
    return sweep()


# Killed -------------------------------------------------------------------------------------------


def test_survives_kills(tmp_path):
    said = []
    _, wrong = torture(tmp_path, SMALL, kills=1, seed=9, say=said.append, whole=Here)
    assert wrong == [], "\n".join(said)
    assert sum(line.startswith("kill ") for line in said) == 1


def test_an_interrupted_sweep_is_gone_on_with(begun, expected):
    before = {file: file.stat().st_mtime_ns for file in files(begun)}
    done = zarr.open_array(begun / "sweep/done")[:]
    assert 4 <= done.sum() <= 6
    numbers = []
    with solved(numbers.append):
        result = sweep(begun)
    assert len(numbers) == CHUNKS - done.sum()
    assert {file: file.stat().st_mtime_ns for file in before} == before
    assert_same(result, expected)
    with solved(numbers.append):
        sweep(begun)
    assert len(numbers) == CHUNKS - done.sum()


def test_a_chunk_is_on_disk_before_it_is_called_done(path, monkeypatch):
    synced, seen, handles = [], [], {}
    replace, open_file = Path.replace, os.open

    def remember_open(file, *how, **more):
        handle = open_file(file, *how, **more)
        handles[handle] = Path(file)
        return handle

    def remember_fsync(handle):
        synced.append(handles[handle])

    def remember_replace(self, target):
        seen.append((Path(target), list(synced)))
        return replace(self, target)

    monkeypatch.setattr(os, "open", remember_open)
    monkeypatch.setattr(os, "fsync", remember_fsync)
    monkeypatch.setattr(Path, "replace", remember_replace)
    monkeypatch.setattr("ratestate.sweeps.task.cores", lambda: 1)
    sweep(path)
    written = {target for target, _ in seen if path in target.parents}
    # the first time that each was written
    flags = {file: before for file, before in reversed(seen) if "sweep/done/c" in str(file)}
    assert len(flags) == CHUNKS
    for flag, before in flags.items():
        i, j = divmod(int(flag.name), 2)
        keys = [f"c/{i}/{j}", f"c/{i}/{j}/0"]
        keys += ([] if j else [f"f_n/c/{i}"]) + ([] if i else [f"omega_c/c/{j}"])
        keys += [f"sweep/manifest/c/{flag.name}"]
        results = [file for file in written if str(file).endswith(tuple(keys))]
        assert len(results) >= 5 + (j == 0) + (i == 0)
        for file in results:
            assert file in before
            # and so are the folders that name it, up to those that were made with the store
            for folder in itertools.takewhile(lambda one: one != path, file.parents):
                assert folder in before, folder
        assert flag in synced


def test_files_cut_off_by_a_kill_are_removed(begun, expected):
    for name in ("growth_rate/c/3/1.0123.partial", "sweep/done/c/7.0123.partial"):
        (begun / name).parent.mkdir(exist_ok=True, parents=True)
        (begun / name).write_bytes(b"half a chu")
    assert_same(sweep(begun), expected)
    assert leftovers(begun) == []


def test_half_a_store_left_by_a_kill_is_removed(tmp_path):
    name = "x[1]*.zarr"  # no pattern
    left = tmp_path / f".{name}.0123.partial"
    (left / "M").mkdir(parents=True)
    (left / "zarr.json").write_text("{")
    sweep(tmp_path / name, chunk=WHOLE)
    assert not left.exists()


def test_half_a_store_is_removed_when_another_sweep_made_the_store(begun):
    left = begun.parent / f".{begun.name}.0123.partial"
    left.mkdir()
    sweep(begun)
    assert not left.exists()


def test_stores_that_are_being_made_by_others_stay(tmp_path):
    other = tmp_path / ".x.zarr.0123.partial"
    other.mkdir()
    sweep(tmp_path / "y.zarr", chunk=WHOLE)
    assert other.exists()
    handle = create_module.lock_folder(other)
    sweep(tmp_path / "x.zarr", chunk=WHOLE)
    os.close(handle)
    assert other.exists()


# Gone ---------------------------------------------------------------------------------------------


MOMENTS = {
    "a chunk is solved": (task, "solve", 3),
    "a file is written": (writing._Present, "set_sync", 20),
    "files are synced": (writing, "to_disk", 5),
    "files are summed up": (writing, "manifest_entry", 3),
}


@contextlib.contextmanager
def vanishing(moment, vanish):
    """Within, `vanish` is called at a moment of `MOMENTS`, of a sweep on one thread."""
    owner, name, when = MOMENTS[moment]
    function, numbers = getattr(owner, name), itertools.count()

    def called(*arguments):
        if next(numbers) == when:
            vanish()
        return function(*arguments)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ratestate.sweeps.task.cores", lambda: 1)
        patch.setattr(owner, name, called)
        yield


@pytest.mark.parametrize("moment", MOMENTS)
def test_a_store_that_vanishes_is_not_made_again(moment, path):
    gone = pytest.raises(StoreError, match=r"x\.zarr is gone, or a part of it.*Put it back")
    with vanishing(moment, lambda: shutil.rmtree(path)), gone:
        sweep(path)
    assert [*path.parent.iterdir()] == []


def test_a_store_that_was_renamed_is_gone_on_with(path, expected):
    kept = path.with_name("kept")
    gone = pytest.raises(StoreError, match=r"x\.zarr is gone, or a part of it.*Put it back")
    with vanishing("a file is written", lambda: path.rename(kept)), gone:
        sweep(path)
    assert [*path.parent.iterdir()] == [kept]
    kept.rename(path)
    assert store_status(path).done > 0
    assert_same(sweep(path), expected)


def test_an_array_that_vanishes_is_not_made_again(path):
    def remove(number):
        if number == 3:
            shutil.rmtree(path / "K_c")

    with solved(remove), pytest.raises(StoreError, match=r"x\.zarr is gone, or a part of it"):
        sweep(path)
    assert not (path / "K_c").exists()


# Interrupted --------------------------------------------------------------------------------------


def test_an_interrupted_sweep_says_how_to_go_on(path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("ratestate.sweeps.request.SweepRequest.divide", interrupt)
        with pytest.raises(
            KeyboardInterrupt, match=r"Nothing is stored in .*x\.zarr\. Run the same"
        ):
            sweep(path)
    assert not path.exists()
    monkeypatch.setattr("ratestate.sweeps.task.cores", lambda: 1)

    def later(number):
        if number == 3:
            raise KeyboardInterrupt

    said = r"interrupted\. 6 of 16 cases are stored in .*x\.zarr\. Run the same sweep again"
    with solved(later), pytest.raises(KeyboardInterrupt, match=said):
        sweep(path)
    assert store_status(path).done == 6


# Full ---------------------------------------------------------------------------------------------


def test_no_room_for_a_chunk(path):
    asked = {"M": rs.logspace("M", 1, 1e4, 100), "V_lp": rs.logspace("V_lp", 1e-3, 1e-2, 200)}
    asked["chunk"] = 10000
    with largest_file(50_000), pytest.raises(StoreError, match="File too large") as error:
        sweep(path, **asked)
    assert "make room" in str(error.value)
    assert "run the same sweep again" in str(error.value)
    assert store_status(path).done == 0
    assert leftovers(path.parent) == []
    assert_same(sweep(path, **asked), sweep(**asked))


def test_no_room_for_a_store(path):
    with largest_file(1000), pytest.raises(StoreError, match="File too large") as error:
        sweep(path)
    assert f"{path} cannot be made" in str(error.value)
    assert "room" in str(error.value)
    assert list(path.parent.iterdir()) == []


@pytest.fixture
def disk(tmp_path):
    """A disk of 1 MB, and how to give it another size."""
    place = tmp_path / "disk"
    place.mkdir()

    def mount(*options):
        command = ["mount", *options, "tmpfs", str(place)]
        return subprocess.run(command, capture_output=True, check=False).returncode == 0

    try:
        mounted = mount("-t", "tmpfs", "-o", "size=1m")
    except FileNotFoundError:
        mounted = False
    if not mounted:
        pytest.skip("a disk can be mounted by root only")
    yield place, lambda size: mount("-o", f"remount,size={size}")
    subprocess.run(["umount", "--lazy", str(place)], check=True)


def test_a_full_disk(disk):
    place, resize = disk
    path = place / "x.zarr"
    asked = {"V_lp": rs.logspace("V_lp", 1e-3, 1e-2, 10), "chunk": 2}
    whole = sweep(**asked)
    for _ in range(2):  # again without room: no better, no worse
        with pytest.raises(StoreError, match="No space left on device") as error:
            sweep(path, **asked)
        assert "make room" in str(error.value)
        assert "run the same sweep again" in str(error.value)
        assert leftovers(place) == []
        there = store_status(path)
        assert 3 <= there.chunks_done < there.chunks == 20
        done = zarr.open_array(path / "sweep/done")[:].reshape(4, 5).repeat(2, axis=1)
        part = xr.open_zarr(path, chunks=None)
        for name in ("growth_rate", "eigenvalues", "status", "K_c"):
            where = done if part[name].ndim > 1 else done.any(axis=1)
            assert same(part[name].values[where], whole[name].values[where])
    flags = list((path / "sweep/done/c").iterdir())
    results = [path / f"growth_rate/c/{int(flag.name) // 5}/{int(flag.name) % 5}" for flag in flags]
    before = {file: file.stat().st_mtime_ns for file in flags + results}
    assert resize("8m")
    assert_same(sweep(path, **asked), whole)
    assert {file: file.stat().st_mtime_ns for file in before} == before


def test_no_room_on_the_disk_for_a_store(disk):
    place, resize = disk
    assert resize("64k")
    with pytest.raises(StoreError, match="No space left on device"):
        sweep(place / "x.zarr")
    assert list(place.iterdir()) == []


# Read-only ----------------------------------------------------------------------------------------

OTHERS = f"""
import os, sys, warnings
warnings.simplefilter("error")
import xarray as xr
sys.path[:0] = {[str(Path(__file__).parent), str(TESTS / "helpers")]!r}
from test_store import StoreError, store_status, sweep
sweep(sys.argv[1] + "/warm.zarr", chunk=16)  # all that is imported and compiled lazily
xr.open_zarr(sys.argv[1] + "/warm.zarr", chunks=None).load()
store_status(sys.argv[1] + "/warm.zarr")
if os.getuid() == 0:  # whom no permissions bind
    os.setgroups([])
    os.setgid(65534)
    os.setuid(65534)
os.chdir(sys.argv[1])
for path in sys.argv[2:]:
    try:
        sweep(path)
        print("done")
    except StoreError as error:
        print(str(error).replace(chr(10), " "))
    except Exception as error:
        print(f"{{type(error).__name__}}: {{error}}".replace(chr(10), " "))
status = store_status("x.zarr")
print(status.chunks_done, int((xr.open_zarr("x.zarr", chunks=None).status == 0).sum()))
"""


def test_read_only_or_in_use_by_another_process(begun):
    # not in pytest's folder, which nobody else may enter
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        shutil.copytree(begun, folder / "x.zarr")
        shutil.copytree(begun, folder / "half.zarr")
        for path in (folder / "half.zarr/sweep").rglob("*"):
            path.chmod(0o777)  # the lock, the flags: all but the results
        (folder / "closed").mkdir(mode=0o700)
        shutil.copytree(begun, folder / "closed/x.zarr")
        if os.getuid():
            (folder / "closed").chmod(0o000)
            (folder / "new").mkdir(mode=0o555)
            for path in [*(folder / "x.zarr").rglob("*"), *(folder / "half.zarr").glob("[!s]*/*")]:
                path.chmod(0o555)
        before = files(folder / "x.zarr")
        shutil.copytree(begun, folder / "busy.zarr")
        for path in (folder / "busy.zarr").rglob("*"):
            path.chmod(0o777)
        stores = ["x.zarr", "half.zarr", "new.zarr", "closed/x.zarr", "closed/new.zarr"]
        command = [sys.executable, "-c", OTHERS, name, *stores, "busy.zarr"]
        with exclusive_lock(folder / "busy.zarr/sweep/zarr.json", "busy.zarr"):
            done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=name)
        assert done.returncode == 0, done.stderr
        store, half, new, closed, closed_new, busy, rest = done.stdout.splitlines()
        assert store.startswith("x.zarr cannot be written to (Permission denied); mend")
        assert "what it holds is whole" in store
        assert half.startswith("half.zarr cannot be written to ([Errno 13] Permission denied")
        assert new.startswith("new.zarr cannot be made (Permission denied)")
        assert closed.startswith("closed/x.zarr cannot be read (Permission denied)")
        assert "(Permission denied)" in closed_new
        assert busy.startswith("another sweep is writing to busy.zarr; wait until")
        assert rest == f"{store_status(begun).chunks_done} {store_status(begun).done}"
        assert files(folder / "x.zarr") == before


# Two at once --------------------------------------------------------------------------------------


def in_thread(path, outcomes):
    def run():
        try:
            outcomes.append(sweep(path).load())
        except Exception as error:
            outcomes.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    return thread


def test_two_threads_on_a_store(begun, expected):
    running, go_on, outcomes = threading.Event(), threading.Event(), []

    def pause(_):
        running.set()
        go_on.wait(20)

    with solved(pause):
        thread = in_thread(begun, outcomes)
        assert running.wait(20)
        with pytest.raises(StoreError, match=r"another sweep is writing to .*x.zarr; wait until"):
            sweep(begun)
        go_on.set()
        thread.join(20)
    assert_same(outcomes[0], expected)
    sweep(begun)  # the lock is gone


# zarr's warnings: filters are common to all threads, and come and go with any of them
@pytest.mark.filterwarnings("ignore:Consolidated metadata is", "ignore:The data type")
def test_two_threads_make_a_store(path, expected, monkeypatch):
    both, outcomes = threading.Barrier(2, timeout=20), []
    fill = create_module._write_static

    def wait_for_the_other(*arguments):
        fill(*arguments)
        with contextlib.suppress(threading.BrokenBarrierError):
            both.wait()

    monkeypatch.setattr(create_module, "_write_static", wait_for_the_other)
    threads = [in_thread(path, outcomes) for _ in range(2)]
    for thread in threads:
        thread.join(30)
    errors = [outcome for outcome in outcomes if isinstance(outcome, Exception)]
    assert len(errors) < 2
    for outcome in outcomes:
        if isinstance(outcome, Exception):
            assert is_clear(outcome, path)
        else:
            assert_same(outcome, expected)
    assert leftovers(path.parent) == []
    assert_same(sweep(path), expected)


def is_clear(error, path):
    """Whether an error says that another sweep has the store."""
    known = (f"another sweep is writing to {path};", f"another sweep made {path} meanwhile;")
    return isinstance(error, StoreError) and str(error).startswith(known)


def test_the_half_made_store_of_another_thread_stays(path, monkeypatch):
    """It is not mistaken for one that a kill left, however early the other looks."""
    lock_folder, first, outcomes = create_module.lock_folder, threading.Event(), []

    def look_before(folder):
        if not first.is_set():
            first.set()
            in_thread(path, outcomes).join(10)
        return lock_folder(folder)

    monkeypatch.setattr(create_module, "lock_folder", look_before)
    in_thread(path, outcomes).join(20)
    assert len(outcomes) == 2
    errors = [outcome for outcome in outcomes if isinstance(outcome, Exception)]
    assert len(errors) < 2
    assert all(is_clear(error, path) for error in errors), errors
    assert leftovers(path.parent) == []


def test_a_store_is_whole_or_absent(path, monkeypatch, expected):
    """Another sweep looks for what a kill left just as this one takes hold of its half store."""
    lock_folder, fill, inputs_of = (
        create_module.lock_folder,
        create_module._write_static,
        create_module.inputs_of,
    )
    main, outcomes, looked = threading.main_thread(), [], threading.Event()
    folders = []

    def hold_what_another_looks_at(folder):
        folders.append(folder)
        if len(folders) > 1:
            return lock_folder(folder)
        handle = os.open(folder, os.O_RDONLY)
        fcntl.flock(handle, fcntl.LOCK_EX)
        threading.Timer(0.2, os.close, [handle]).start()
        try:
            return lock_folder(folder)
        finally:
            time.sleep(0.3)

    def fill_until_full(*arguments):
        if threading.current_thread() is not main:
            raise OSError(28, "No space left on device")
        fill(*arguments)

    def look_meanwhile(*arguments):
        if threading.current_thread() is main and not looked.is_set():
            looked.set()
            in_thread(path, outcomes).join(10)
        return inputs_of(*arguments)

    monkeypatch.setattr(create_module, "lock_folder", hold_what_another_looks_at)
    monkeypatch.setattr(create_module, "_write_static", fill_until_full)
    monkeypatch.setattr(create_module, "inputs_of", look_meanwhile)
    assert_same(sweep(path), expected)
    assert [type(outcome) for outcome in outcomes] == [StoreError]
    assert leftovers(path.parent) == []


# Another sweep ------------------------------------------------------------------------------------


def test_of_other_parameters(begun):
    before = files(begun)
    with pytest.raises(StoreError) as error:
        sweep(
            begun,
            a=0.004,
            M=AXES["M"] * 1.5,
            V_lp=rs.logspace("V_lp", 1e-3, 1e-1, 4),
            sigma=rs.logspace("sigma", 1e6, 2e6, 2),
            law="aging",
            chunk=4,
        )
    first, *lines = str(error.value).splitlines()
    assert first.startswith(f"{begun} holds another sweep; give this one a store of its own")
    found = {line.strip().partition(":")[0]: line for line in lines}
    assert set(found) == {"a", "M", "V_lp", "sigma", "law", "chunk"}
    assert "0.003 in the store, 0.004 now" in found["a"]
    assert "4 of 4 values differ, first at M[0]: 100.0 kg/m^2 in the store, 150.0" in found["M"]
    assert "3 of 4 values differ, first at V_lp[1]: " in found["V_lp"]
    assert "2000000.0 Pa in the store, <sigma: 2; 1e+06 to 2e+06 Pa> now" in found["sigma"]
    assert "slip in the store, aging now" in found["law"]
    assert "(1, 2) cases in the store, chunk=4 now" in found["chunk"]
    assert files(begun) == before


def test_of_a_slider_that_differs_in_the_last_bit(begun):
    slider, symbols = rs.SpringSlider(**POINT), ["a", "b", "Dc", "sigma", "K", "mu0", "V0"]
    with pytest.raises(StoreError) as error:
        sweep(begun, **{one: float(np.nextafter(getattr(slider, one), 1e99)) for one in symbols})
    found = {line.strip().partition(":")[0] for line in str(error.value).splitlines()[1:]}
    assert found == {*symbols}


def test_of_an_axis_that_differs_in_the_last_bit(begun):
    V_lp = AXES["V_lp"].copy()
    V_lp[2] = np.nextafter(V_lp[2], 1.0)
    with pytest.raises(StoreError, match=r"V_lp: 1 of 4 values differ, first at V_lp\[2\]"):
        sweep(begun, V_lp=xr.DataArray(V_lp.values, dims="V_lp"))


def test_of_another_dimension(begun):
    M = xr.DataArray(AXES["M"].values, dims="depth")
    with pytest.raises(StoreError, match=r"M: <M: 4; .*> in the store, <depth: 4; .*> now"):
        sweep(begun, M=M)


def test_of_another_verb(begun):
    with pytest.raises(StoreError, match="verb: stability in the store, limit_cycle now"):
        sweep(begun, "limit_cycle")


MOTION = {
    "loading": rs.Loading.steps("1 mm/s", (0.01, "3 mm/s")),
    "t_end": 0.03,
    "times": [0.0, 0.01, 0.03],
    "V_start": 1e-3,
    "M": AXES["M"][:2],
}


@pytest.fixture(scope="module")
def motion(tmp_path_factory):
    path = tmp_path_factory.mktemp("motion") / "x.zarr"
    sweep(path, "simulate", **MOTION)
    return path


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"loading": rs.Loading.steps("1 mm/s", (0.01, "4 mm/s"))}, {"loading 1 step V"}),
        ({"loading": rs.Loading.steps("1 mm/s", (0.02, "3 mm/s"))}, {"loading 1 step t"}),
        ({"times": [0.0, 0.03]}, {"times"}),
        ({"times": None}, {"times"}),
        ({"V_start": None}, {"V_start"}),
        ({"initial": {"theta": 0.1}}, {"initial theta"}),
        ({"rtol": 1e-5, "t_end": 0.05}, {"rtol", "t_end"}),
    ],
)
def test_of_another_motion(motion, changed, named):
    with pytest.raises(StoreError) as error:
        sweep(motion, "simulate", **MOTION | changed)
    assert {line.strip().partition(":")[0] for line in str(error.value).splitlines()[1:]} == named


# No store, or a damaged one -----------------------------------------------------------------------


def put_file(path):
    path.write_text("results")


def put_folder(path):
    path.mkdir()


def put_group(path):
    zarr.create_group(path).create_array("V", shape=(3,), dtype=float)


def put_dataset(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        sweep(V_lp=1e-3, chunk=10).drop_vars("message").to_zarr(path)


@pytest.mark.parametrize("put", [put_file, put_folder, put_group, put_dataset])
def test_what_is_no_store_stays_as_it_is(path, put):
    put(path)
    before = files(path.parent)
    for use in (sweep, store_status):
        with pytest.raises(StoreError, match=r"x.zarr is no store of a sweep"):
            use(path)
    assert files(path.parent) == before
    assert list(path.parent.iterdir()) == [path]


def test_no_folder_to_make_a_store_in(tmp_path):
    with pytest.raises(StoreError, match=r"x.zarr cannot be made \(No such file or directory\)"):
        sweep(tmp_path / "missing/x.zarr")
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match=r"x.zarr cannot be made \(Not a directory\)"):
        sweep(tmp_path / "file/x.zarr")
    with pytest.raises(
        StoreError, match=r"there is nothing at .*x.zarr: no sweep has stored a chunk"
    ):
        store_status(tmp_path / "missing/x.zarr")


def test_relative_paths_and_text(tmp_path, monkeypatch, expected):
    monkeypatch.chdir(tmp_path)
    assert_same(sweep("x.zarr"), expected)
    assert [path.name for path in tmp_path.iterdir()] == ["x.zarr"]


RECORDS = [
    "sweep/zarr.json",
    "sweep/inputs/zarr.json",
    "sweep/inputs/M/zarr.json",
    "sweep/inputs/M/c/0",
]


@pytest.mark.filterwarnings("ignore:Object at")  # zarr's way of saying that it is lost
@pytest.mark.parametrize("name", RECORDS)
@pytest.mark.parametrize("use", [sweep, store_status], ids=["sweep", "held"])
def test_records_cut_short_or_lost(begun, name, use):
    content = (begun / name).read_bytes()
    for length in (0, 1, len(content) // 2, len(content) - 1):
        (begun / name).write_bytes(content[:length])
        with pytest.raises(StoreError, match=r"x.zarr"):
            use(begun)
    (begun / name).unlink()
    with pytest.raises(StoreError, match=r"x.zarr"):
        use(begun)


def flipped(file):
    """Flip bits of a file, a byte at a time: the first, one more, or all; and mend it again."""
    content = file.read_bytes()
    for i, mask in zip(range(len(content)), itertools.cycle((0x01, 0x40, 0xFF))):
        file.write_bytes(content[:i] + bytes([content[i] ^ mask]) + content[i + 1 :])
        yield i
    file.write_bytes(content)


def test_a_flipped_bit_is_an_error_and_no_number(path):
    M = xr.DataArray([0.0, 100.0, 3000.0, 1e4], {"M": [1, 2, 3, 4]}, dims="M")
    sweep(path, "limit_cycle", M=M, V_lp=1e-2, chunk=4)
    for name in ("M", "amplitude", "multipliers", "status", "message"):
        array = zarr.open_array(path / name)
        before = array[:]
        file = next(file for file in (path / name / "c").rglob("*") if file.is_file())
        for i in flipped(file):
            try:
                found = array[:]
            except Exception:  # zarr's, of many kinds
                continue
            assert same(found, before), f"byte {i} of {name}"


def test_a_flipped_bit_in_the_parameters(begun):
    for _ in flipped(begun / "sweep/inputs/M/c/0"):
        try:
            _, inputs = store_module.read_record(begun)
        except StoreError:
            continue
        np.testing.assert_array_equal(inputs.M, AXES["M"])


def test_a_flipped_bit_in_a_flag_calls_nothing_done(begun):
    done = zarr.open_array(begun / "sweep/done")[:]
    flag = begun / f"sweep/done/c/{np.flatnonzero(done)[0]}"
    array = zarr.open_array(begun / "sweep/done")
    for i in flipped(flag):
        try:
            found = array[:]
        except Exception:
            continue
        assert not (found & ~done).any(), f"byte {i}"


# Read again ---------------------------------------------------------------------------------------


def cases():
    """Name of a sweep -> what it is asked."""
    bare = xr.DataArray([100.0, 300.0, 1000.0], dims="case")
    square = xr.DataArray([[1e8, 2e8, 4e8], [5e8, 6e8, 9e8]], dims=("z", "case"))
    rocks = {"rock": ["gouge", "granite", "serpentinite"]}
    extra = {"x": [1, 2, 3], "depth": ("x", [1.5, 2.5, 3.5]), "site": ("x", ["a", "b", "long"])}
    days = {"day": np.array(["2026-11-20", "2026-11-21"], "M8[ns]")}
    own = xr.DataArray([[0.0, 0.01, 0.02], [0.0, 0.005, 0.03]], dims=("M", "time"))
    return {
        "of one number": ("stability", {"V_lp": 1e-3, "chunk": 4}),
        "limit cycles": ("limit_cycle", {"M": [0, 1e2, 3e3], "V_lp": [1e-3, 1e-1]}),
        "runs": ("simulate", MOTION),
        "ends of runs": ("simulate", MOTION | {"times": None}),
        "times for each case": ("simulate", MOTION | {"times": own}),
        "in the plane": ("stability", {"M": bare, "K": square, "chunk": 5}),
        # a label for each value, more coordinates along an axis, times for an axis; out of order
        "coordinates": (
            "stability",
            {
                "b": xr.DataArray([0.005, 0.006, 0.007], rocks, dims="rock"),
                "M": xr.DataArray([100.0, 300.0, 1000.0], extra, dims="x"),
                "V_lp": xr.DataArray([1e-3, 1e-2], days, dims="day"),
                "chunk": 9,
            },
        ),
        "a dimension named for a parameter of two dimensions": (
            "stability",
            {"K": square.rename(z="K"), "M": 1e3, "V_lp": 1e-3},
        ),
        "a parameter over the axis of another": (
            "stability",
            {"K": xr.DataArray(np.linspace(1e8, 9e8, 4), dims="M"), "V_lp": AXES["V_lp"][:2]},
        ),
    }


def asked(name):
    verb, arguments = cases()[name]
    for symbol in ("M", "V_lp"):
        if isinstance(arguments.get(symbol), list):
            arguments[symbol] = xr.DataArray(arguments[symbol], dims=symbol)
    return verb, arguments


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Name of a sweep -> the path of its store, and what the sweep returns, numbers unread."""
    paths: dict = {}

    def store(name):
        verb, arguments = asked(name)
        path = paths.setdefault(name, tmp_path_factory.mktemp("stored") / "x.zarr")
        return path, sweep(path, verb, **arguments)

    return store


@pytest.mark.parametrize("name", cases())
def test_read_again(stored, name):
    verb, arguments = asked(name)
    path, returned = stored(name)
    expected = sweep(None, verb, **arguments)
    again = xr.open_zarr(path)  # no warning
    for result in (returned, again):
        assert set(result.coords) == set(expected.coords)
        assert_same(result.load(), expected)
        assert set(result.indexes) == set(expected.indexes)
        for key, index in expected.indexes.items():
            assert index.equals(result.indexes[key])
        assert result.attrs == expected.attrs
        for key, variable in expected.variables.items():
            found = {k: np.asarray(v).tolist() for k, v in result[key].attrs.items()}
            assert found == {k: np.asarray(v).tolist() for k, v in variable.attrs.items()}, key
            kinds = (result[key].dtype.kind, variable.dtype.kind)
            assert kinds[0] == kinds[1] or set(kinds) <= set("OTU"), key


def test_types_and_what_is_not_a_number(stored):
    _, result = stored("limit cycles")
    assert result.status.dtype == np.int8
    assert result.multipliers.dtype == np.complex128
    assert result.stable.dtype.kind == "b" or result.stable.dtype == float
    assert set(np.unique(result.status)) == {0, 1, 5}
    nan = np.isnan(result.multipliers.values).all(axis=-1)
    np.testing.assert_array_equal(nan, result.status.values != 0)
    assert (result.message.values != "").tolist() == (result.status.values == 5).tolist()
    assert (result.amplitude.values[result.status.values == 1] == 0.0).all()


def test_to_netcdf(stored, tmp_path):
    path, returned = stored("coordinates")
    engine = {"engine": "h5netcdf", "invalid_netcdf": True}  # complex numbers
    for result in (returned, xr.open_zarr(path)):
        file = tmp_path / "x.nc"
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", ".*invalid netcdf.*")
            result.to_netcdf(file, **engine)
        with xr.open_dataset(file, engine="h5netcdf") as again:
            assert set(again.variables) == set(result.variables)
            for key in ("status", "message"):
                assert same(again[key].values, result[key].values)


# What is held -------------------------------------------------------------------------------------


def test_held_and_failures_of_part_of_a_sweep(path):
    M = xr.DataArray([0.0, 100.0, 3000.0, 1e4], dims="M")
    asked = {"M": M, "V_lp": rs.logspace("V_lp", 1e-3, 1e-1, 4)}
    interrupted(path, after=5, verb="limit_cycle", **asked)
    done = zarr.open_array(path / "sweep/done")[:]
    assert 4 <= done.sum() <= 6
    whole = sweep(None, "limit_cycle", **asked)
    where = done.reshape(4, 2).repeat(2, axis=1)
    status = np.where(where, whole.status.values, -1)
    there, data = store_status(str(path)), xr.open_zarr(path, chunks=None)
    np.testing.assert_array_equal(data.status, status)
    assert (data.amplitude.values[~where] == NO_RESULT).all()
    assert (data.multipliers.values[~where] == complex(NO_RESULT, NO_RESULT)).all()
    assert np.isfinite(whole.amplitude.values[whole.status == 0]).all()
    masked = read(path)
    np.testing.assert_array_equal(masked.status, status)
    assert np.isnan(masked.amplitude.values[~where]).all()
    assert np.isnan(masked.multipliers.values[~where]).all()
    assert same(masked.amplitude.values[where], whole.amplitude.values[where])
    assert same(masked.multipliers.values[where], whole.multipliers.values[where])
    assert there.path == path
    assert (there.verb, there.dims) == ("limit_cycle", {"M": 4, "V_lp": 4})
    assert (there.cases, there.done) == (16, 2 * done.sum())
    assert (there.chunks, there.chunks_done) == (8, done.sum())
    assert there.failed == (status > 1).sum() >= 3
    assert there.steady == (status == 1).sum()
    assert there.versions["numpy"] == np.__version__
    assert there.size == sum(map(len, files(path).values()))
    first, number = failures(data, most=2)
    assert number == there.failed
    assert [name for _, name, _ in first] == ["quasi_static_instability"] * 2
    assert first[1][0] == {"M": 0.0, "V_lp": whole.V_lp.values[1]}
    assert "V grows without bound" in first[0][2]
    sweep(path, "limit_cycle", **asked)
    there = store_status(path)
    assert (there.done, there.chunks_done) == (16, 8)
    assert there.failed == (whole.status > 1).sum()


def test_held_before_anything_is_done(path):
    interrupted(path, after=0)
    there = store_status(path)
    assert (there.done, there.failed, there.steady, there.chunks_done) == (0, 0, 0, 0)
    data = xr.open_zarr(path)
    assert (data.status == -1).all()
    assert failures(data) == ([], 0)


def test_a_sweep_that_cannot_be_asked_makes_no_store(path):
    with pytest.raises(ParameterError):
        sweep(path, "limit_cycle", rtol=1.0)
    assert list(path.parent.iterdir()) == []
