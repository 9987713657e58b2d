"""Stores of sweeps that were damaged, or made by others: seen, named, computed again or refused."""

import json
import random
import shutil

import numpy as np
import pytest
import xarray as xr
from test_store import CHUNKS, assert_same, files, interrupted, solved, sweep

from ratestate.errors import StoreError
from ratestate.files import read
from ratestate.interfaces.cli.sweep_store import print_status
from ratestate.sweeps import identity
from ratestate.sweeps import sweep as sweep_module
from ratestate.sweeps.status import store_status
from ratestate.sweeps.store import NO_RESULT, open_result


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


def empty(file):
    file.write_bytes(b"")


def lose(file):
    file.unlink()


def repaired(path, match):
    """The result of the sweep, with a warning that matches; and how many chunks were computed."""
    numbers: list = []
    with solved(numbers.append), pytest.warns(RuntimeWarning, match=match) as warned:
        result = sweep(path)
    assert len(warned) == 1
    assert store_status(path, verify=True).flaws == []
    return result, len(numbers)


# Damaged ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("harm", "how"), [(flip, "damaged"), (empty, "damaged"), (lose, "missing")]
)
def test_a_chunk_is_named_and_computed_again(path, expected, harm, how):
    before = files(path)
    harm(path / "growth_rate/c/2/1")
    named = rf"variable growth_rate, chunk 5 \(growth_rate/c/2/1\) is {how}"
    status = store_status(path, verify=True)
    assert (len(status.flaws), status.chunks_done) == (1, CHUNKS - 1)
    assert (store_status(path).flaws, store_status(path).chunks_done) == (None, CHUNKS)
    with pytest.raises(StoreError, match=rf"(?s)Run the same sweep again.*{named}"):
        read(path)
    result, number = repaired(path, named)
    assert number == 1
    assert_same(result, expected)
    assert files(path) == before


def test_a_damaged_status_names_its_chunk(path, expected):
    flip(path / "status/c/3/1")
    with pytest.raises(StoreError, match=r"chunk 7 \(status/c/3/1\) is damaged"):
        store_status(path)
    result, number = repaired(path, r"variable status, chunk 7")
    assert number == 1
    assert_same(result, expected)


def test_a_lost_variable_of_several_chunks_is_computed_again_once(path, expected):
    lose(path / "f_n/c/3")
    result, number = repaired(path, r"variable f_n, chunk 6 \(f_n/c/3\) is missing")
    assert number == 1
    assert_same(result, expected)


def test_damage_is_found_again_after_an_interrupt(path, expected):
    flip(path / "growth_rate/c/2/1")
    lose(path / "omega/c/2/0")

    def interrupt(number):
        raise KeyboardInterrupt

    with solved(interrupt), pytest.raises(KeyboardInterrupt), pytest.warns(RuntimeWarning):
        sweep(path)
    result, number = repaired(path, "chunk 5")
    assert number == 2
    assert_same(result, expected)


@pytest.mark.parametrize(("name", "harm"), [("M/c/0", flip), ("M/c/0", lose), ("K_c_qs/c", flip)])
def test_damaged_variables_of_the_whole_sweep_are_refused(path, name, harm):
    harm(path / name)
    before = files(path)
    for use in (sweep, read):
        with pytest.raises(StoreError, match=rf"Put them back from a copy.*(?s:.)*\({name}\) is"):
            use(path)
    assert files(path) == before


@pytest.mark.filterwarnings("ignore:Object at")  # zarr's way of saying that it is lost
@pytest.mark.parametrize("name", ["zarr.json", "sweep/zarr.json"])
def test_metadata_cut_short_or_lost(path, name):
    content = (path / name).read_bytes()
    for length in (0, 1, len(content) // 2, len(content) - 1, None):
        if length is None:
            (path / name).unlink()
        else:
            (path / name).write_bytes(content[:length])
        for use in (sweep, lambda path: store_status(path, verify=True)):
            with pytest.raises(StoreError, match=r"x.zarr: its metadata are damaged .* a copy"):
                use(path)


def test_sizes_that_do_not_fit_the_variables(path):
    file = path / "sweep/zarr.json"
    group = json.loads(file.read_text())
    for name, value in [("sizes", {"M": 5, "V_lp": 4}), ("sizes", {"M": 4}), ("chunk", [0, 2])]:
        changed = group | {"attributes": group["attributes"] | {name: value}}
        file.write_text(json.dumps(changed))
        for use in (sweep, store_status):
            with pytest.raises(StoreError, match=r"metadata are damaged \(sizes do not agree"):
                use(path)


def test_a_changed_byte_is_an_error_and_no_number(path, expected):
    dice = random.Random(13)
    for file in dice.sample(sorted(one for one in path.glob("[!s]*/c/**/*") if one.is_file()), 20):
        content = file.read_bytes()
        i = dice.randrange(len(content))
        file.write_bytes(content[:i] + bytes([content[i] ^ 2]) + content[i + 1 :])
        if store_status(path, verify=True).flaws == []:  # in a part without meaning
            assert_same(open_result(path).load(), expected)
        file.write_bytes(content)


def test_without_sweep_a_lost_file_shows(path):
    for name in ("growth_rate", "eigenvalues", "M", "status"):
        shutil.rmtree(path / name / "c")
    data = xr.open_zarr(path, chunks=None)
    assert (data.growth_rate == NO_RESULT).all()
    assert (data.eigenvalues == complex(NO_RESULT, NO_RESULT)).all()
    assert (data.M == NO_RESULT).all()
    assert (data.status == -1).all()


def test_the_status_names_damaged_files(path, capsys):
    print_status(path, None, None, json=False, verify=True)
    assert "verified  all files are intact" in capsys.readouterr().out
    lose(path / "growth_rate/c/2/1")
    print_status(path, None, None, json=False)
    assert "verified" not in capsys.readouterr().out
    for as_json in (False, True):
        with pytest.raises(StoreError, match=r"chunk 5 \(growth_rate/c/2/1\) is missing"):
            print_status(path, None, None, json=as_json, verify=True)
    said, document = capsys.readouterr().out.split("{", 1)
    assert "verified  damaged or missing files: 1\n" in said
    (flaw,) = json.loads("{" + document)["flaws"]
    assert flaw.endswith("(growth_rate/c/2/1) is missing")


# Made by others -----------------------------------------------------------------------------------


@pytest.fixture
def other_origin(monkeypatch):
    """Have this process take itself for another: on another processor, of other versions."""
    now = identity.origin("cpu")

    def be(cpu=None, lack=(), **other):
        target, name, features = identity.this_processor()
        kept = ",".join(one for one in features.split(",") if one[1:] not in lack)
        monkeypatch.setattr(identity, "this_processor", lambda: (target, cpu or name, kept))
        monkeypatch.setattr(identity, "versions", lambda: json.dumps(now["versions"] | other))

    return be


FOREIGN = {
    "processor": ({"cpu": "i386"}, r"processor, cpu: \S+ in the store, i386 now$"),
    "features": ({"lack": ["sse2"]}, r"processor, feature sse2: used in the store, none now$"),
    "llvmlite": ({"llvmlite": "0.1"}, r"version of llvmlite: 0\.\d.* in the store, 0\.1 now$"),
    "kernels": ({"kernels": "abc", "ratestate": "9"}, "kernels: .* in the store, abc now"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_other_machines_do_not_resume_a_store(begun, other_origin, name):
    who, difference = FOREIGN[name]
    before = files(begun)
    other_origin(**who)
    with pytest.raises(StoreError, match=rf"(?s)last digits.*{difference}"):
        sweep(begun)
    assert files(begun) == before


def test_other_machines_read_a_complete_store(path, expected, other_origin):
    other_origin(cpu="i386", kernels="abc")
    assert_same(sweep(path), expected)


def test_another_version_with_the_same_kernels_resumes(begun, expected, other_origin):
    other_origin(ratestate="9")
    assert_same(sweep(begun), expected)


def test_other_variables_are_refused(begun, monkeypatch):
    plain, before = sweep_module.form_of, files(begun)

    def changed_form(call):
        form = plain(call)
        del form.specs["K_c"]
        omega = form.specs["omega"]._replace(dtype=np.dtype("f4"))
        return form._replace(specs=form.specs | {"omega": omega, "more": form.specs["status"]})

    monkeypatch.setattr(sweep_module, "form_of", changed_form)
    lines = [
        r"variable K_c: float64 over \(M, V_lp\) in the store, none now",
        r"variable more: none in the store, int8 over \(M, V_lp\) now",
        r"variable omega: float64 over \(M, V_lp\) in the store, float32 over \(M, V_lp\) now",
    ]
    with pytest.raises(StoreError, match=r"\n  ".join(lines)):
        sweep(begun)
    assert files(begun) == before


# Stores of earlier versions -----------------------------------------------------------------------


def test_an_old_store_is_read_and_not_resumed(begun, expected):
    """It recorded no arguments, and a chunk was done later than its files were written."""
    record = json.loads((begun / "sweep/zarr.json").read_text())
    for name in ("processor", "arguments", "variables"):
        del record["attributes"][name]
    (begun / "sweep/zarr.json").write_text(json.dumps(record))
    torn = next(one for one in (begun / "growth_rate/c").rglob("*") if one.is_file())
    lose(torn)
    status = store_status(begun, verify=True)
    assert (len(status.flaws), status.processor) == (1, "")
    found = read(begun).growth_rate.values
    assert np.isnan(found).sum() == 2 * (CHUNKS - status.chunks_done)
    assert np.array_equal(found[~np.isnan(found)], expected.growth_rate.values[~np.isnan(found)])
    before = files(begun)
    with pytest.raises(StoreError, match=r"earlier version of ratestate\. It can be read"):
        sweep(begun)
    assert files(begun) == before
