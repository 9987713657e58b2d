"""Stores of sweeps: what is put in comes out, and no accident takes it away."""

import contextlib
import itertools
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import zarr
from limits import largest_file
from paths import ROOT, TESTS
from torture import SMALL, Here, same, torture

import ratestate as rs
from ratestate.errors import StoreError
from ratestate.files import read
from ratestate.sweeps import sweep as sweep_module
from ratestate.sweeps import tasks, writing
from ratestate.sweeps.status import failures, store_status
from ratestate.sweeps.store import NO_RESULT, Store
from ratestate.sweeps.writing import exclusive_lock

POINT = {"a": 0.003, "b": 0.006, "Dc": "10 um", "sigma": "2 MPa", "K": "900 MPa/m"}
# 16 cases in 8 chunks: (M, V_lp) in blocks of (1, 2).
AXES = {"M": rs.logspace("M", 100, 1e4, 4), "V_lp": rs.logspace("V_lp", 1e-3, 1e-2, 4)}
CHUNKS, CHUNK = 8, 2


def asked_of(changes):
    """Return the slider and the arguments with the parameters above, but for these."""
    values = POINT | AXES | changes
    own = {"V_lp", "rtol", "method", "loading", "t_end", "times", "initial", "V_start"}
    slider = rs.SpringSlider(**{k: v for k, v in values.items() if k not in own})
    arguments = {k: v for k, v in values.items() if k in own}
    if "loading" in arguments:
        del arguments["V_lp"]
    return slider, arguments


def sweep(path=None, function="stability", *, chunk=CHUNK, **changes):
    slider, arguments = asked_of(changes)
    return rs.sweep(function, slider, store=path, chunk=chunk, progress=False, **arguments)


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
        solve = tasks.solve

        def solving(*arguments):
            before(next(numbers))
            return solve(*arguments)

        patch.setattr(tasks, "solve", solving)
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


def test_a_store_survives_killed_processes(tmp_path):
    said = []
    _, wrong = torture(tmp_path, SMALL, kills=1, seed=9, say=said.append, whole=Here)
    assert wrong == [], "\n".join(said)
    assert sum(line.startswith("kill ") for line in said) == 1


def test_an_interrupted_sweep_is_gone_on_with(begun, expected):
    before = {file: file.stat().st_mtime_ns for file in files(begun)}
    done = Store.open(begun).done()
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


def test_the_status_of_a_chunk_is_written_when_all_else_is_on_the_disk(path, monkeypatch):
    synced, before, rename = set(), {}, Path.replace

    def remember_replace(file, target):
        before[target] = set(synced)
        return rename(file, target)

    monkeypatch.setattr(os, "fsync", lambda handle: synced.add(os.fstat(handle).st_ino))
    monkeypatch.setattr(Path, "replace", remember_replace)
    monkeypatch.setattr("ratestate.sweeps.tasks.cores", lambda: 1)
    sweep(path)
    marks = {file: on_disk for file, on_disk in before.items() if file.parts[-4] == "status"}
    assert len(marks) == CHUNKS
    for mark, on_disk in marks.items():
        i, j = mark.parts[-2:]
        keys = [f"c/{i}/{j}", f"c/{i}/{j}/0"]
        keys += ([] if int(j) else [f"f_n/c/{i}"]) + ([] if int(i) else [f"omega_c/c/{j}"])
        others = [file for file in before if str(file).endswith(tuple(keys)) and file != mark]
        assert len(others) >= 4 + (j == "0") + (i == "0")
        for file in others:  # and so are the folders that name it, up to the array's
            folders = itertools.takewhile(lambda one: one.parent != path, file.parents)
            for one in (file, *folders):
                assert one.stat().st_ino in on_disk, one
        assert mark.stat().st_ino in synced


def test_files_cut_off_by_a_kill_are_removed(begun, expected):
    left = begun / "growth_rate/c/3/1.0123.partial"
    left.parent.mkdir(exist_ok=True)
    left.write_bytes(b"half a chu")
    assert_same(sweep(begun), expected)
    assert leftovers(begun) == []


def test_half_a_store_left_by_a_kill_is_made_anew(path, expected):
    left = path.with_name(f".{path.name}.partial")
    (left / "other").mkdir(parents=True)
    (left / "zarr.json").write_text("{" * 10_000)
    assert_same(sweep(path), expected)
    assert [*path.parent.iterdir()] == [path]
    assert not (path / "other").exists()


# Gone ---------------------------------------------------------------------------------------------


MOMENTS = {
    "a chunk is solved": (tasks, "solve", 3),
    "files are synced": (writing, "_sync", 5),
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
        patch.setattr("ratestate.sweeps.tasks.cores", lambda: 1)
        patch.setattr(owner, name, called)
        yield


@pytest.mark.parametrize("moment", MOMENTS)
def test_a_store_that_vanishes_is_not_made_again(moment, path):
    gone = pytest.raises(StoreError, match=r"x\.zarr or a part of it was removed .*Put it back")
    with vanishing(moment, lambda: shutil.rmtree(path)), gone:
        sweep(path)
    assert [*path.parent.iterdir()] == []


def test_an_array_that_vanishes_is_computed_again(path, expected, monkeypatch):
    monkeypatch.setattr("ratestate.sweeps.tasks.cores", lambda: 1)

    def remove(number):
        if number == 3:
            shutil.rmtree(path / "K_c")

    with solved(remove), pytest.raises(StoreError, match="Run the same sweep again"):
        sweep(path)
    with pytest.warns(RuntimeWarning, match="variable K_c"):
        assert_same(sweep(path), expected)


# Interrupted --------------------------------------------------------------------------------------


def test_an_interrupted_sweep_says_how_to_go_on(path, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("ratestate.sweeps.sweep.Request.divide", interrupt)
        with pytest.raises(
            KeyboardInterrupt, match=r"Nothing is stored in .*x\.zarr\. Run the same"
        ):
            sweep(path)
    assert not path.exists()
    monkeypatch.setattr("ratestate.sweeps.tasks.cores", lambda: 1)

    def later(number):
        if number == 3:
            raise KeyboardInterrupt

    with solved(later), pytest.raises(KeyboardInterrupt, match="results of the sweep are lost"):
        sweep()
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
    assert "Make room" in str(error.value)
    assert "run the same sweep again" in str(error.value)
    assert store_status(path).done == 0
    assert leftovers(path.parent) == []
    assert_same(sweep(path, **asked), sweep(**asked))


def test_no_room_for_a_store(path):
    with largest_file(1000), pytest.raises(StoreError, match="File too large") as error:
        sweep(path)
    assert f"{path} cannot be created" in str(error.value)
    assert "room" in str(error.value)
    assert list(path.parent.iterdir()) == []


# Read-only ----------------------------------------------------------------------------------------

OTHERS = f"""
import os, sys
sys.path[:0] = {[str(Path(__file__).parent), str(TESTS / "helpers"), str(ROOT / "tools")]!r}
from test_store import StoreError, store_status, sweep
sweep(sys.argv[1] + "/warm.zarr", chunk=16)  # all that is imported and compiled lazily
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
print(store_status("x.zarr").chunks_done)
"""


def test_read_only_or_in_use_by_another_process(begun):
    # not in pytest's folder, which nobody else may enter
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        for store in ("x.zarr", "half.zarr", "busy.zarr", "closed/x.zarr"):
            shutil.copytree(begun, folder / store)
        (folder / "half.zarr/zarr.json").chmod(0o777)  # the lock: all but the results
        (folder / "busy.zarr/zarr.json").chmod(0o777)
        (folder / "closed").chmod(0o700)
        if os.getuid():
            (folder / "closed").chmod(0o000)
            (folder / "new").mkdir(mode=0o555)
            for path in [*(folder / "x.zarr").rglob("*"), *(folder / "half.zarr").glob("[!s]*/*")]:
                path.chmod(0o555)
        before = files(folder / "x.zarr")
        said = {
            "x.zarr": "x.zarr cannot be written to (Permission denied). Its results are intact",
            "half.zarr": "half.zarr cannot be written to ([Errno 13] Permission denied",
            "new.zarr": "new.zarr cannot be created (Permission denied)",
            "closed/x.zarr": "closed/x.zarr cannot be read (Permission denied)",
            "busy.zarr": "Another sweep is writing to busy.zarr. Wait until",
        }
        command = [sys.executable, "-c", OTHERS, name, *said]
        with exclusive_lock(folder / "busy.zarr/zarr.json", "busy.zarr"):
            done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=name)
        assert done.returncode == 0, done.stderr
        *lines, rest = done.stdout.splitlines()
        for line, beginning in zip(lines, said.values(), strict=True):
            assert line.startswith(beginning)
        assert rest == f"{store_status(begun).chunks_done}"
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
        with pytest.raises(StoreError, match=r"Another sweep is writing to .*x.zarr. Wait until"):
            sweep(begun)
        go_on.set()
        thread.join(20)
    assert_same(outcomes[0], expected)
    sweep(begun)  # the lock is gone


def test_a_store_that_another_sweep_makes_meanwhile_stays(path, expected, monkeypatch):
    outcomes = []

    def create_too_late(*arguments):
        monkeypatch.setattr(sweep_module, "create", writing.create)
        in_thread(path, outcomes).join(20)
        writing.create(*arguments)

    monkeypatch.setattr(sweep_module, "create", create_too_late)
    assert_same(sweep(path), expected)
    assert_same(outcomes[0], expected)
    assert [*path.parent.iterdir()] == [path]


# Another sweep ------------------------------------------------------------------------------------


def differences(path, function="stability", **changes):
    """What differs in a sweep that is refused: name -> the line of the message."""
    before = files(path)
    with pytest.raises(StoreError) as error:
        sweep(path, function, **changes)
    first, *lines = str(error.value).splitlines()
    assert first.startswith(f"{path} holds another sweep. Give this sweep a store of its own")
    assert files(path) == before
    return {line.strip().partition(":")[0]: line for line in lines}


LAST_BIT = ("a", "b", "Dc", "sigma", "K", "mu0", "V0")


def next_of(symbol):
    """The value of a slider's parameter that differs in the last bit."""
    return float(np.nextafter(getattr(rs.SpringSlider(**POINT), symbol), 1e99))


#: what is changed, and what is told of it
CHANGES = {
    "values": ({"a": 0.004, "law": "aging"}, {"a": "0.003 in the store, 0.004", "law": "slip in"}),
    "chunks": ({"chunk": 4}, {"chunk": "(1, 2) cases in the store, chunk=4 now"}),
    "axes": (
        {"M": AXES["M"] * 1.5, "V_lp": rs.logspace("V_lp", 1e-3, 1e-1, 4)},
        {"M": "<M: 4; 100 to 10000 kg/m^2; SHA-256", "V_lp": "in the store, <V_lp: 4; "},
    ),
    "an axis": (
        {"sigma": rs.logspace("sigma", 1e6, 2e6, 2)},
        {"sigma": "2000000.0 Pa in the store, <sigma: 2; 1e+06 to 2e+06 Pa; SHA"},
    ),
    "the last bit": ({s: next_of(s) for s in LAST_BIT}, dict.fromkeys(LAST_BIT, "in the store")),
    # its labels are the same
    "the last bit of an axis": (
        {"V_lp": AXES["V_lp"].copy(data=np.nextafter(AXES["V_lp"], 1.0))},
        {"V_lp": "in the store, <V_lp: 4; "},
    ),
    "the name of an axis": (
        {"M": xr.DataArray(AXES["M"].values, dims="depth")},
        {"M": "in the store, <depth: 4; "},
    ),
    "the function": (
        {"function": "limit_cycle"},
        {"function": "stability in the store, limit_cycle now", "rtol": "none in the store"},
    ),
}


@pytest.mark.parametrize(("changes", "told"), CHANGES.values(), ids=CHANGES)
def test_another_sweep_is_refused_with_the_differences(changes, told, begun):
    found = differences(begun, **changes)
    assert found.keys() == told.keys()
    assert all(words in found[name] for name, words in told.items()), found


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
        ({"loading": rs.Loading.steps("1 mm/s", (0.01, "4 mm/s"))}, {"loading 1 step V_lp"}),
        ({"loading": rs.Loading.steps("1 mm/s", (0.02, "3 mm/s"))}, {"loading 1 step t"}),
        ({"times": [0.0, 0.03]}, {"times"}),
        ({"times": None}, {"times"}),
        ({"V_start": None}, {"V_start"}),
        ({"initial": {"theta": 0.1}}, {"initial theta"}),
        ({"rtol": 1e-5, "t_end": 0.05}, {"rtol", "t_end"}),
    ],
)
def test_a_sweep_of_other_runs_is_refused(motion, changed, named):
    assert differences(motion, "simulate", **MOTION | changed).keys() == named


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
def test_other_files_are_not_changed(path, put):
    put(path)
    before = files(path.parent)
    for use in (sweep, store_status):
        with pytest.raises(StoreError, match=r"x.zarr is not a store of a sweep"):
            use(path)
    assert files(path.parent) == before
    assert list(path.parent.iterdir()) == [path]


def test_no_folder_to_make_a_store_in(tmp_path):
    with pytest.raises(StoreError, match=r"x.zarr cannot be created \(No such file or directory\)"):
        sweep(tmp_path / "missing/x.zarr")
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match=r"x.zarr cannot be created \(Not a directory\)"):
        sweep(tmp_path / "file/x.zarr")
    with pytest.raises(
        StoreError, match=r"There is nothing at .*x.zarr\. No sweep has stored a chunk"
    ):
        store_status(tmp_path / "missing/x.zarr")


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
        "times for each case": ("simulate", MOTION | {"times": own, "method": "rodas5p"}),
        "an end and a state for each case": (
            "simulate",
            MOTION
            | {"times": None, "t_end": xr.DataArray([0.03, 0.02], dims="M")}
            | {"initial": {"theta": xr.DataArray([1.0, 2.0], dims="M")}},
        ),
        "a speed at the start": (
            "simulate",
            MOTION | {"times": None, "V_start": xr.DataArray([1e-3, 2e-3], dims="start")},
        ),
        "one value": ("limit_cycle", {"M": [2e3], "V_lp": 3.2e-3}),
        "no mass, no spring": (
            "limit_cycle",
            {"M": [0.0, 2e3], "K": xr.DataArray([9e8, np.inf], dims="K"), "V_lp": 3.2e-3},
        ),
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
    function, arguments = cases()[name]
    for symbol in ("M", "V_lp"):
        if isinstance(arguments.get(symbol), list):
            arguments[symbol] = xr.DataArray(arguments[symbol], dims=symbol)
    return function, arguments


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Name of a sweep -> the path of its store, and what the sweep returns, numbers unread."""
    paths: dict = {}

    def store(name):
        function, arguments = asked(name)
        path = paths.setdefault(name, tmp_path_factory.mktemp("stored") / "x.zarr")
        return path, sweep(path, function, **arguments)

    return store


@pytest.mark.parametrize("name", cases())
def test_a_stored_sweep_is_read_again(stored, name):
    function, arguments = asked(name)
    path, returned = stored(name)
    expected = sweep(None, function, **arguments)
    slider, own = asked_of({k: v for k, v in arguments.items() if k != "chunk"})
    alone = getattr(rs, function)(slider, **own)
    added = ["message"] if "status" in alone else ["message", "status"]
    xr.testing.assert_identical(expected.drop_vars(added), alone)
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


# What is held -------------------------------------------------------------------------------------


def test_status_and_failures_of_part_of_a_sweep(path):
    M = xr.DataArray([0.0, 100.0, 3000.0, 1e4], dims="M")
    asked = {"M": M, "V_lp": rs.logspace("V_lp", 1e-3, 1e-1, 4)}
    interrupted(path, after=5, function="limit_cycle", **asked)
    done = Store.open(path).done()
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
    assert (there.function, there.dims) == ("limit_cycle", {"M": 4, "V_lp": 4})
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


def test_status_before_anything_is_done(path):
    interrupted(path, after=0)
    there = store_status(path)
    assert (there.done, there.failed, there.steady, there.chunks_done) == (0, 0, 0, 0)
    data = xr.open_zarr(path)
    assert (data.status == -1).all()
    assert failures(data) == ([], 0)
