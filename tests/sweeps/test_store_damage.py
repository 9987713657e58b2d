"""Stores of sweeps that were damaged, or begun by others: seen, named, mended or refused."""

import json
import random
import shutil
import warnings

import numpy as np
import pytest
import xarray as xr
import zarr
from test_store import CHUNKS, assert_same, files, interrupted, solved, sweep

from ratestate.errors import SolverError, StoreError
from ratestate.files import read
from ratestate.interfaces.cli.store_report import print_status
from ratestate.sweeps import origin, request, resume, task
from ratestate.sweeps.manifest import RECORDS
from ratestate.sweeps.status import store_status
from ratestate.sweeps.store import open_result
from ratestate.sweeps.writing import NO_RESULT


@pytest.fixture(scope="module")
def expected():
    return sweep()


@pytest.fixture(scope="module")
def pattern(tmp_path_factory):
    path = tmp_path_factory.mktemp("pattern") / "x.zarr"
    sweep(path)
    return path


@pytest.fixture
def path(tmp_path, pattern):
    """A store of 8 chunks, all done."""
    shutil.copytree(pattern, tmp_path / "x.zarr")
    return tmp_path / "x.zarr"


@pytest.fixture(scope="module")
def half(tmp_path_factory):
    return interrupted(tmp_path_factory.mktemp("half") / "x.zarr")


@pytest.fixture
def begun(tmp_path, half):
    """A store of which some chunks are done."""
    shutil.copytree(half, tmp_path / "x.zarr")
    return tmp_path / "x.zarr"


def flip(file):
    """Change one bit in the middle of a file."""
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0x10
    file.write_bytes(content)


def lose(file):
    file.unlink()


def swap(file):
    """Swap a chunk's file with that of another chunk of the variable."""
    other = file.parent.parent / "3" / file.name
    one, two = file.read_bytes(), other.read_bytes()
    assert one != two
    file.write_bytes(two)
    other.write_bytes(one)


def flaws_of(path):
    """What verifying a store says."""
    try:
        return "\n".join(store_status(path, verify=True).flaws)
    except StoreError as error:
        return str(error)


def mended(path, match):
    """The result of the sweep, with a warning that matches; and how many chunks were computed."""
    numbers: list = []
    with solved(numbers.append), pytest.warns(RuntimeWarning, match=match) as warned:
        result = sweep(path)
    assert len(warned) == 1
    assert store_status(path, verify=True).flaws == []
    return result, len(numbers)


# Damaged ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("harm", "chunks", "how"), [(flip, 1, "damaged"), (lose, 1, "missing"), (swap, 2, "damaged")]
)
def test_a_chunk_is_named_and_computed_again(path, expected, harm, chunks, how):
    before = files(path)
    harm(path / "growth_rate/c/2/1")
    named = rf"variable growth_rate, chunk 5 \(growth_rate/c/2/1\) is {how}"
    flaws = store_status(path, verify=True).flaws
    assert len(flaws) == chunks
    assert store_status(path, verify=True).chunks_done == CHUNKS - chunks
    assert store_status(path).flaws is None
    assert store_status(path).chunks_done == CHUNKS
    with pytest.raises(StoreError, match="run the same sweep again") as error:
        read(path)
    (line,) = str(error.value).splitlines()[1:]  # of two, the one that is read first
    assert line.strip() in flaws
    result, number = mended(path, named)
    assert number == chunks
    assert_same(result, expected)
    assert files(path) == before


def test_what_is_common_to_chunks_is_computed_again_by_the_one_that_has_it(path, expected):
    lose(path / "f_n/c/3")
    result, number = mended(path, r"variable f_n, chunk 6 \(f_n/c/3\) is missing")
    assert number == 1
    assert_same(result, expected)


@pytest.mark.parametrize("name", ["sweep/done/c/7", "sweep/manifest/c/7"])
def test_a_damaged_flag_or_entry_is_that_of_its_chunk(path, expected, name):
    before = files(path)
    flip(path / name)
    assert store_status(path).chunks_done == CHUNKS - ("done" in name)
    result, number = mended(path, rf"variable {name[:-4]}, chunk 7 \({name}\) is damaged")
    assert number == 1
    assert_same(result, expected)
    assert files(path) == before


def test_swapped_entries_of_the_manifest(path, expected):
    one, two = (path / f"sweep/manifest/c/{i}" for i in (1, 4))
    content = one.read_bytes()
    one.write_bytes(two.read_bytes())
    two.write_bytes(content)
    assert len(store_status(path, verify=True).flaws) == 2
    result, number = mended(path, "chunk 4 .sweep/manifest/c/4. is damaged")
    assert number == 2
    assert_same(result, expected)


MADE = [
    ["zarr.json"],
    ["K_c/zarr.json", "M/c/0", "K_c_qs/c"],
    ["sweep/manifest/zarr.json"],
    [f"sweep/manifest/c/{CHUNKS}"],
]


@pytest.mark.filterwarnings("ignore:Object at")  # zarr's way of saying that it is lost
@pytest.mark.parametrize("names", MADE)
def test_what_was_made_with_the_store_is_made_again(path, expected, names):
    before = files(path)
    for name in names:
        content = (path / name).read_bytes()
        # a change that readers take as it is, where there are words
        changed = content.replace(b"Pa", b"mm").replace(b"zstd", b"zsts")[:-1] + b" "
        (path / name).write_bytes(changed)
    found = flaws_of(path)
    assert all(name in found for name in names)
    result, number = mended(path, "(?s)" + ".*".join(f"({name})" for name in sorted(names)))
    assert number == 0
    assert_same(result, expected)
    assert result.attrs == expected.attrs
    assert files(path) == before
    assert [one.name for one in path.parent.iterdir()] == [path.name]


def change_a_byte(file, dice):
    content = file.read_bytes()
    i = dice.randrange(len(content))
    file.write_bytes(content[:i] + bytes([content[i] ^ 2]) + content[i + 1 :])
    return content


@pytest.mark.filterwarnings("ignore:Object at")
def test_any_change_of_a_byte_is_seen(path):
    """In chunks, and in metadata, attributes among them."""
    dice = random.Random(13)
    chunks = sorted(one for one in path.glob("[!s]*/c/**/*") if one.is_file())
    contents = {file: change_a_byte(file, dice) for file in chunks}
    seen = store_status(path, verify=True).flaws
    for file, content in contents.items():
        key = file.relative_to(path).as_posix()
        assert sum(f"({key}) is damaged" in flaw for flaw in seen) == 1
        file.write_bytes(content)
    for file in dice.sample(sorted(path.rglob("zarr.json")), 20):
        content = change_a_byte(file, dice)
        assert "damaged" in flaws_of(path), file
        file.write_bytes(content)
    assert store_status(path, verify=True).flaws == []


@pytest.mark.parametrize(
    ("name", "value"), [("sizes", {"M": 5, "V_lp": 4}), ("sizes", {"M": 4}), ("chunk", [0, 2])]
)
def test_sizes_that_do_not_fit_the_flags(path, name, value):
    """A digit changed in the record of the sweep ended in an IndexError or ZeroDivisionError."""
    file = path / "sweep/zarr.json"
    group = json.loads(file.read_text())
    assert name in group["attributes"]
    group["attributes"][name] = value
    file.write_text(json.dumps(group))
    for use in (sweep, store_status, lambda path: store_status(path, verify=True)):
        with pytest.raises(StoreError, match=r"\(sweep/zarr.json\) is damaged"):
            use(path)


def test_what_cannot_be_mended_is_left_as_it_is(path, monkeypatch):
    flip(path / "M/c/0")
    before = files(path)
    now = json.loads(origin.versions())
    monkeypatch.setattr(resume, "versions", lambda: json.dumps(now | {"ratestate": "9"}))
    with pytest.raises(StoreError, match=r"put back from a copy:\n  variable M, chunk .* damaged"):
        sweep(path)
    assert files(path) == before


@pytest.mark.parametrize("harm", [lose, lambda file: file.write_text("{")])
def test_the_group_of_the_sweep_itself(path, harm):
    """What is known of the sweep is gone, and the results are not: no word of another path only."""
    harm(path / "sweep/zarr.json")
    for use in (sweep, store_status):
        with pytest.raises(StoreError, match=r"record of the parameters is damaged .* from a copy"):
            use(path)
    assert (xr.open_zarr(path, chunks=None).status == 0).any()


def test_without_sweep_a_lost_file_shows(path):
    names = ["growth_rate", "eigenvalues", "M", "status"]
    for name in names:
        shutil.rmtree(path / name / "c")
    data = xr.open_zarr(path, chunks=None)
    assert (data.growth_rate == NO_RESULT).all()
    assert (data.eigenvalues == complex(NO_RESULT, NO_RESULT)).all()
    assert (data.M == NO_RESULT).all()
    assert (data.status == -1).all()


def test_status_says_what_is_damaged(path, capsys):
    print_status(path, None, None, json=False, verify=True)
    assert "verified  all files are as they were written" in capsys.readouterr().out
    lose(path / "growth_rate/c/2/1")
    print_status(path, None, None, json=False)
    assert "verified" not in capsys.readouterr().out
    for as_json in (False, True):
        with pytest.raises(StoreError, match=r"chunk 5 \(growth_rate/c/2/1\) is missing"):
            print_status(path, None, None, json=as_json, verify=True)
    said, document = capsys.readouterr().out.split("{", 1)
    assert "verified  damaged or missing files: 1\n" in said
    assert len(json.loads("{" + document)["flaws"]) == 1


@pytest.mark.parametrize(
    ("error", "seen", "message", "legacy"),
    [
        (TypeError("spanner"), TypeError, "^spanner$", False),
        (KeyError("spanner"), KeyError, "spanner", True),
        (OSError(5, "Input/output error"), StoreError, r"x\.zarr cannot be read .*Input/o", False),
    ],
)
def test_an_error_of_the_program_is_no_damage(begun, monkeypatch, error, seen, message, legacy):
    """Where all files are as they were written, nothing is said of damage."""

    def broken(*_):
        raise error

    if legacy:
        as_of_old(begun)
    before = files(begun)
    with monkeypatch.context() as patch:
        patch.setattr(resume, "_variables", broken)
        with pytest.raises(seen, match=message):
            sweep(begun)
        assert files(begun) == before
        lose(begun / "f_n/c/0")  # now there is damage, and it may be to blame
        with pytest.raises(StoreError, match=r"is damaged.*\n.*f_n/c/0"):
            sweep(begun)


def test_an_error_of_the_package_is_itself_even_beside_damage(begun, monkeypatch):
    """A lost cluster is not called a damaged store, whatever else the store lacks."""

    def lost(*_):
        raise SolverError("the cluster is lost")

    lose(begun / "f_n/c/0")
    monkeypatch.setattr(resume, "_check_origins", lost)
    with pytest.raises(SolverError, match=r"^the cluster is lost$"):
        sweep(begun)


def test_what_cannot_be_written_is_not_taken_for_damage_alone(begun, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    lose(begun / "zarr.json")
    monkeypatch.setattr(resume, "make", full)
    with pytest.raises(StoreError, match=r"cannot be written to .*No space left.*\n.*zarr.json"):
        sweep(begun)
    monkeypatch.undo()
    with pytest.warns(RuntimeWarning, match="made again"):
        sweep(begun)


def test_a_file_without_a_byte_is_damage(begun):
    path = next(one for one in (begun / "growth_rate/c").rglob("*") if one.is_file())
    path.write_bytes(b"")
    with pytest.raises(StoreError, match=r"growth_rate/c.* is damaged"):
        open_result(begun).load()


# Made by others -----------------------------------------------------------------------------------


@pytest.fixture
def other_origin(monkeypatch):
    """Have this process take itself for another: on another processor, of other versions."""
    now = origin.origin("cpu")

    def be(cpu=None, lack=(), **other):
        processor = dict(now["processor"])
        features = [name for name in processor["features"].split() if name not in lack]
        processor |= {"features": " ".join(features)} | ({"cpu": cpu} if cpu else {})
        text = json.dumps(now["versions"] | other)
        monkeypatch.setattr(origin, "processor", lambda device: processor)
        monkeypatch.setattr(origin, "versions", lambda: text)
        monkeypatch.setattr(resume, "versions", lambda: text)
        return processor

    return be


FOREIGN = {
    "processor": ({"cpu": "i386"}, r"processor: \S+ made the store, i386 is here$"),
    "features": ({"lack": ["sse2"]}, r"is here \(only there: sse2\)$"),
    "llvmlite": (
        {"llvmlite": "0.1"},
        r"version of llvmlite: 0\.\d.* made the store, 0\.1 is here$",
    ),
    "kernels": ({"kernels": "abc", "ratestate": "9"}, "kernels: .* made the store, abc is here"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_others_do_not_go_on(begun, other_origin, name):
    who, difference = FOREIGN[name]
    before = files(begun)
    other_origin(**who)
    with pytest.raises(StoreError, match=difference) as error:
        sweep(begun)
    assert "mixed=True (--mixed)" in str(error.value)
    assert files(begun) == before


def test_others_go_on_if_asked(begun, expected, other_origin):
    who, difference = FOREIGN["features"]
    own = store_status(begun).chunks_done
    other_origin(**who)
    with pytest.warns(RuntimeWarning, match=difference):
        result = sweep(begun, mixed=True)
    assert_same(result, expected)
    origins = store_status(begun, verify=True).origins
    assert [one["chunks"] for one in origins] == [own, CHUNKS - own]
    assert origins[0] != origins[1]
    for key in ("versions", "processor"):
        assert origins[1][key] == origin.origin("cpu")[key]
    assert_same(sweep(begun), expected)  # nothing is left to be done, and anybody may read


def test_another_version_with_the_same_kernels_goes_on(begun, expected, other_origin):
    other_origin(ratestate="9")
    assert_same(sweep(begun), expected)
    assert [one["versions"]["ratestate"] for one in store_status(begun).origins][1] == "9"


def test_what_another_version_finds(begun, expected, monkeypatch):
    """Another version that knows one variable more, or less, or has it of another type."""
    plain = request.form_of

    def other(change):
        def form(call):
            found = plain(call)
            return found._replace(specs=change(dict(found.specs)))

        return form

    def less(specs):
        del specs["omega"]
        return specs

    def more(specs):
        return specs | {"returns": specs["status"]}

    def narrower(specs):
        return specs | {"omega": specs["omega"]._replace(dtype=np.dtype("f4"))}

    before, solve = files(begun), task.solve

    def with_returns(part, specs, progress=None):
        found = solve(part, specs, progress)
        return found | {"returns": found["status"]}

    lines = {
        less: r"variable omega: float64 over \(M, V_lp\) in the store, none now$",
        more: r"variable returns: none in the store, int8 over \(M, V_lp\) now$",
        narrower: r"omega: float64 over \(M, V_lp\) in the store, float32 over \(M, V_lp\) now$",
    }
    for change, mixed in [(less, False), (less, True), (more, False), (narrower, True)]:
        monkeypatch.setattr(request, "form_of", other(change))
        with pytest.raises(StoreError, match=lines[change]):
            sweep(begun, mixed=mixed)
        assert files(begun) == before
    with monkeypatch.context() as patch:
        patch.setattr(request, "form_of", other(more))
        patch.setattr(task, "solve", with_returns)
        with pytest.warns(RuntimeWarning, match=lines[more]):
            assert_same(sweep(begun, mixed=True), expected)


def test_workers_of_another_kind_are_refused(other_origin):
    expected = origin.origin("cpu")
    other_origin(cpu="i386")
    with pytest.raises(StoreError, match=r"i386 is here") as error:
        task.call_on_worker(expected, "cpu", int)
    assert "mixed=True" in str(error.value)
    assert task.call_on_worker(expected | {"processor": None}, "cpu", max, 3, 4) == 4


# Older stores -------------------------------------------------------------------------------------


def as_of_old(path):
    """A store as version 0.1.0 made it: without a manifest, filled with NaN."""
    shutil.rmtree(path / "sweep/manifest")
    record = json.loads((path / "sweep/zarr.json").read_text())
    del record["attributes"][RECORDS]
    (path / "sweep/zarr.json").write_text(json.dumps(record))
    for file in path.glob("*/zarr.json"):
        node = json.loads(file.read_text())
        if node.get("data_type") == "float64":
            node["fill_value"] = "NaN"
        file.write_text(json.dumps(node))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        zarr.consolidate_metadata(path)
    return path


def test_an_older_store_is_read_verified_and_gone_on_with(begun, expected):
    as_of_old(begun)
    done = store_status(begun, verify=True)
    assert done.flaws == []
    assert [one["processor"] for one in done.origins] == [None]
    assert np.isnan(read(begun).growth_rate.values).sum() == 2 * (CHUNKS - done.chunks_done)
    with pytest.warns(RuntimeWarning, match="does not say on what kind of processor"):
        assert_same(sweep(begun), expected)
    after = store_status(begun, verify=True)
    assert after.flaws == []
    own = done.chunks_done
    assert [one["chunks"] for one in after.origins] == [own, CHUNKS - own]
    assert after.origins[1]["processor"] == origin.processor("cpu")


def test_damage_of_an_older_store(path, expected):
    as_of_old(path)
    for harm, how in ((flip, "damaged"), (lose, "missing")):
        harm(path / "growth_rate/c/2/1")
        named = rf"variable growth_rate, chunk 5 \(growth_rate/c/2/1\) is {how}"
        assert len(store_status(path, verify=True).flaws) == 1
        with pytest.raises(StoreError, match=named):
            read(path)
        with pytest.warns(RuntimeWarning) as warned:
            assert_same(sweep(path), expected)
        assert any(named.replace("\\", "") in str(one.message) for one in warned)
    file = path / "K_c/zarr.json"
    file.write_text(file.read_text().replace("Pa", "mm"))
    with pytest.raises(StoreError, match=r"put back from a copy:\n  metadata \(K_c/zarr.json\)"):
        sweep(path)
