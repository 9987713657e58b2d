"""Results as files: round trips, CSV, places that are found bad beforehand, whole files only."""

import contextlib
import csv
import io
import json
import os
import pickle
import random
import shutil
import stat
import warnings
from pathlib import Path

import h5py
import numcodecs
import numpy as np
import pytest
import xarray as xr
import zarr

import ratestate as rs
from ratestate import ParameterError, files, machine
from ratestate.errors import StoreError
from ratestate.files.stored import raw_netcdf
from ratestate.records.reading.open_table import read_hdf5
from ratestate.sweeps.status import store_status
from ratestate.sweeps.store import open_result, zarr_3_warnings_ignored

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=5e8, M=3e3)
M = xr.DataArray([0.0, 3e3], dims="M")
#: kinds of results, among them NaN, inf, complex numbers, text, yes and no, flags, three dimensions
RESULTS = {
    "run": lambda: rs.simulate(SLIDER, rs.Loading.steps(1e-4, (0.05, 3e-3)), 0.1),
    "cycle": lambda: rs.limit_cycle(SLIDER, 1e-3),
    "rigid": lambda: rs.stability(SLIDER.replace(K=np.inf), 1e-3),
    "branch": lambda: rs.continue_cycle(SLIDER.replace(K=9e8), "V_lp", 3.5e-3, 3e-3, rtol=1e-6),
    "sweep": lambda: rs.sweep(
        "limit_cycle", SLIDER.replace(M=M), V_lp=rs.logspace("V_lp", 1, 2, 2)
    ),
    "runs": lambda: rs.simulate(
        SLIDER.replace(M=M + 1.0),
        rs.Loading.constant(1e-3),
        0.1,
        V_start=9e-4,
        times=[0.0, 0.05, 0.1],
    ),
    "record": lambda: rs.simulate(
        SLIDER, rs.Loading.series(np.linspace(0, 1, 1200), np.full(1200, 1e-3)), 1e-3, V_start=9e-4
    ),
}


@pytest.fixture(scope="module")
def results():
    return {kind: make() for kind, make in RESULTS.items()}


@pytest.mark.parametrize("kind", RESULTS)
@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_results_are_read_from_files_as_they_were(kind, ending, results, tmp_path):
    path = tmp_path / f"x.{ending}"
    assert files.write(results[kind], path) == path
    again = files.read(path)
    xr.testing.assert_identical(again, results[kind])
    for name, variable in results[kind].variables.items():
        same = again[name].dtype == variable.dtype
        assert same or {again[name].dtype.kind, variable.dtype.kind} <= {"O", "U"}, name
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


def test_netcdf_has_nothing_that_others_cannot_read(results, tmp_path):
    for kind in ("rigid", "sweep"):
        path = files.write(results[kind], tmp_path / "x.nc")
        with h5py.File(path) as file:
            for name, variable in file.items():
                assert variable.dtype.kind in "iufO", name  # no compound types
    with xr.open_dataset(tmp_path / "x.nc") as plain:
        multipliers = plain.multipliers_real + 1j * plain.multipliers_imag
        assert plain.multipliers_imag.attrs["long_name"] == "Floquet multipliers, imaginary part"
    np.testing.assert_array_equal(multipliers, results["sweep"].multipliers)


def test_complex_numbers_with_infinite_parts_come_back():
    values = np.array([complex(-np.inf, 0.0), complex(np.nan, 1.0), 1 + 2j])
    attrs = {"units": "1/s", "long_name": "rate"}
    data = xr.Dataset({"rate": ("mode", values, attrs)})
    apart = files.stored.split(data)
    assert {*apart.variables} == {"rate_real", "rate_imag"}
    assert apart.rate_real.values[0] == -np.inf
    xr.testing.assert_identical(files.stored.joined(apart), data)


def rows_of(data):
    return [*csv.DictReader(io.StringIO(files.csv_text(data)))]


def test_csv_of_a_run(results):
    run, rows = results["run"], rows_of(results["run"])
    assert [*rows[0]][:3] == ["time [s]", "V [m/s]", "theta [s]"]
    assert "status" not in rows[0]  # of the run as a whole
    assert "loading_0_V_lp" in results["record"]
    assert "loading" not in files.csv_text(results["record"])
    for column, name in (("time [s]", "time"), ("tau [Pa]", "tau"), ("mu", "mu")):
        np.testing.assert_array_equal([float(row[column]) for row in rows], run[name])


def test_csv_of_whole_numbers_beside_a_missing_one():
    days = np.array(["2020-01-01", "NaT"], "datetime64[ns]")
    text = files.csv_text(xr.Dataset({"day": ("case", days), "x": ("case", [1.5, 2.5])}))
    assert text == "day,x\n1577836800000000000,1.5\n,2.5\n"


def test_csv_of_single_numbers(results):
    (row,) = rows_of(results["cycle"])
    cycle = results["cycle"]
    assert float(row["period [s]"]) == float(cycle.period)
    assert float(row["V_lp [m/s]"]) == 1e-3
    assert (
        complex(float(row["multipliers[0].real"]), float(row["multipliers[0].imag"]))
        == (cycle.multipliers[0])
    )
    assert (row["stable"], row["status"]) == ("1", "0")
    (row,) = rows_of(results["rigid"])
    assert row["eigenvalues[2].real [1/s]"] == "-inf"


def test_csv_of_sweeps(results):
    rows, sweep = rows_of(results["sweep"]), results["sweep"]
    assert len(rows) == 4
    for row, (i, j) in zip(rows, np.ndindex(2, 2), strict=True):
        case = sweep.isel(M=i, V_lp=j)
        assert (float(row["M [kg/m^2]"]), float(row["V_lp [m/s]"])) == (case.M, case.V_lp)
        assert row["message"] == str(case.message.values)
        period = float(case.period)
        assert row["period [s]"] == ("" if np.isnan(period) else repr(period))
    rows, runs = rows_of(results["runs"]), results["runs"]
    assert len(rows) == 6
    assert [float(row["V [m/s]"]) for row in rows] == runs.V.values.ravel().tolist()
    assert [int(row["steps"]) for row in rows] == np.repeat(runs.steps.values, 3).tolist()
    assert [row["special"] for row in rows_of(results["branch"])][:1] == ["start"]


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_a_failed_write_leaves_what_was_there(ending, results, tmp_path, monkeypatch):
    def fails(self, path, *_, **__):
        path.write_text("half")
        raise OSError("disk full")

    path = files.write(results["cycle"], tmp_path / f"x.{ending}")
    monkeypatch.setattr(xr.Dataset, "to_netcdf", fails)
    monkeypatch.setattr(xr.Dataset, "to_zarr", fails)
    monkeypatch.setitem(files.FORMATS, ".csv", (fails, None))
    with pytest.raises(OSError, match="disk full"):
        files.write(results["rigid"], path)
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    if ending != "csv":
        xr.testing.assert_identical(files.read(path), results["cycle"])


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_permissions_and_links_are_kept(ending, results, tmp_path):
    place, link = tmp_path / f"kept.{ending}", tmp_path / "there" / f"x.{ending}"
    link.parent.mkdir()
    link.symlink_to(place)
    files.write(results["cycle"], link)  # which points to nothing yet
    usual = place.stat().st_mode
    place.chmod(0o750)
    files.write(results["rigid"], link)
    assert stat.S_IMODE(place.stat().st_mode) == 0o750 != stat.S_IMODE(usual)
    assert link.readlink() == place
    assert {*tmp_path.rglob("*")} >= {place, link, link.parent}
    assert [*link.parent.iterdir()] == [link]


@pytest.mark.parametrize("failure", [OSError("no"), KeyboardInterrupt()])
def test_a_folder_comes_back_if_the_new_one_cannot_take_its_place(
    failure, results, tmp_path, monkeypatch
):
    path = files.write(results["cycle"], tmp_path / "x.zarr")
    rename = Path.rename

    def fails(self, target):
        if self.name.endswith(".partial.zarr"):
            raise failure
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", fails)
    with pytest.raises(type(failure)):
        files.write(results["rigid"], path)
    assert [one.name for one in tmp_path.iterdir()] == [path.name]
    xr.testing.assert_identical(files.read(path), results["cycle"])


def with_file(folder, name):
    folder.joinpath(name).parent.mkdir(exist_ok=True)
    folder.joinpath(name).write_text("years of work")


FOREIGN = {
    "notes": lambda folder: with_file(folder, "notes.txt"),
    "notes within": lambda folder: with_file(folder, "V/notes.txt"),
    "notes with the data": lambda folder: with_file(folder, "multipliers/c/notes.txt"),
    "hidden": lambda folder: with_file(folder, ".notes"),
    "another array": lambda folder: zarr.create_array(folder / "mine", shape=1, dtype=float),
    "a link": lambda folder: (folder / "mine").symlink_to("V"),
    "no checksums": lambda folder: (folder / "zarr.json").unlink(),
    "broken checksums": lambda folder: with_file(folder, "zarr.json"),
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_a_zarr_with_other_files_is_not_replaced(kind, results, tmp_path):
    path = files.write(results["cycle"], tmp_path / "x.zarr")
    FOREIGN[kind](path)
    before = {one: one.is_file() and one.read_bytes() for one in path.rglob("*")}
    with pytest.raises(ParameterError, match="holds files that are not of one result, and is not"):
        files.write(results["rigid"], path)
    assert {one: one.is_file() and one.read_bytes() for one in path.rglob("*")} == before


def test_an_empty_folder_is_replaced(results, tmp_path):
    (tmp_path / "x.zarr").mkdir()
    path = files.write(results["cycle"], tmp_path / "x.zarr")
    assert files.read(path).identical(results["cycle"])


def test_a_damaged_result_is_replaced(results, tmp_path):
    path = files.write(results["cycle"], tmp_path / "x.zarr")
    shutil.rmtree(path / "period")
    files.write(results["rigid"], path)
    xr.testing.assert_identical(files.read(path), results["rigid"])


def test_only_results_are_replaced(results, tmp_path):
    store = tmp_path / "store.zarr"
    rs.sweep("stability", SLIDER.replace(M=M), V_lp=1e-3, store=store)
    other = tmp_path / "other.zarr"
    other.mkdir()
    (other / "thesis.txt").write_text("years of work")
    deep = tmp_path / "deep.zarr"
    results["cycle"].drop_encoding().to_zarr(deep, group="period/c", consolidated=False)
    foreign = tmp_path / "foreign.zarr"
    results["cycle"].drop_encoding().to_zarr(foreign, consolidated=False)
    file = tmp_path / "file.zarr"
    file.write_text("years of work")
    for path in (store, other, deep, foreign, tmp_path, file):
        with pytest.raises(ParameterError, match=r"unsupported ending|is not replaced|is a file"):
            files.write(results["cycle"], path)
    assert file.read_text() == "years of work"
    assert (store / "sweep").is_dir()
    assert (other / "thesis.txt").exists()
    assert (deep / "period/c").is_dir()


@pytest.fixture
def folder(results, tmp_path):
    return files.write(results["runs"], tmp_path / "x.zarr")


def test_any_lost_or_altered_file_of_a_zarr_is_found(folder, results):
    paths = [path for path in folder.rglob("*") if path.is_file()]
    assert {"zarr.json", "0"} <= {path.name for path in paths}
    refused = 0
    for path in paths:
        content = path.read_bytes()
        path.unlink()
        with pytest.raises(ParameterError, match=r"x\.zarr"):
            files.read(folder)
        for at in (0, len(content) // 2, *range(5, min(len(content), 600), 199)):
            path.write_bytes(content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :])
            try:
                found = files.read(folder)
            except ParameterError:
                refused += 1
            else:  # the bit does not matter
                xr.testing.assert_identical(found, results["runs"])
        path.write_bytes(content)
    assert refused > 2 * len(paths)
    xr.testing.assert_identical(files.read(folder), results["runs"])


def test_flaws_of_a_zarr_are_named(folder):
    (folder / "V/c/0/0").unlink()
    shutil.rmtree(folder / "tau")
    with pytest.raises(ParameterError, match=r"is damaged, or .* in variable V, variable tau"):
        files.read(folder)


def test_a_zarr_without_checksums_is_read(results, tmp_path):
    """As all were written once."""
    path = tmp_path / "x.zarr"
    with zarr_3_warnings_ignored():
        results["cycle"].drop_encoding().to_zarr(path, zarr_format=3)
    xr.testing.assert_identical(files.read(path), results["cycle"])


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_files_that_are_not_results_are_refused(ending, tmp_path):
    path = tmp_path / f"x.{ending}"
    with pytest.raises(ParameterError, match="does not exist"):
        files.read(path)
    path.write_text("not a result")
    with pytest.raises(ParameterError, match="cannot be read as a result"):
        files.read(path)
    with pytest.raises(ParameterError, match="lacks the parameters"):
        files.read(tmp_path / "x.csv")


# NetCDF: checksums, and files that take their data elsewhere ---------------------------------


def test_no_flipped_bit_of_a_netcdf_goes_unnoticed(results, tmp_path):
    """Each place is tried in this process, since a child for each would take a second."""
    path = files.write(results["rigid"], tmp_path / "x.nc")
    content, rng, errors = path.read_bytes(), random.Random(7), set()
    clean = raw_netcdf(path)
    for _ in range(40):
        at = rng.randrange(len(content))
        flipped = content[at] ^ 1 << rng.randrange(8)
        path.write_bytes(content[:at] + bytes([flipped]) + content[at + 1 :])
        try:
            found = raw_netcdf(path)
        except Exception as error:  # also HDF5's own, of its structure
            errors.add(type(error))
        else:
            assert pickle.dumps(found) == pickle.dumps(clean)
    assert ParameterError in errors


def altered_byte(path, number):
    """Flip a bit in a number that is stored in a file as it is."""
    content, bytes_ = path.read_bytes(), np.float64(number).tobytes()
    assert content.count(bytes_) == 1
    at = content.index(bytes_)
    path.write_bytes(content[: at + 7] + bytes([content[at + 7] ^ 0x40]) + content[at + 8 :])


def test_a_damaged_netcdf_names_the_variable(results, tmp_path):
    path = files.write(results["cycle"], tmp_path / "x.nc")
    altered_byte(path, results["cycle"].period)
    with pytest.raises(ParameterError, match=r"x\.nc is damaged.*, in variable period\. Put it"):
        files.read(path)
    path = files.write(results["run"], tmp_path / "y.nc")
    with h5py.File(path) as file:
        chunk = file["tau"].id.get_chunk_info(0)
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size - 1] ^= 1  # of the checksum
    path.write_bytes(content)
    with pytest.raises(ParameterError, match=r"y\.nc is damaged: variable tau cannot be read"):
        files.read(path)


def test_a_netcdf_that_another_program_changed(results, tmp_path, monkeypatch):
    monkeypatch.setattr(machine, "is_child", False)
    path = files.write(results["cycle"], tmp_path / "x.nc")
    with h5py.File(path, "a") as file:
        file.attrs["title"] = "mine"
        digests = json.loads(file.attrs["sha256"])
    assert {*digests} == {*files.stored.split(results["cycle"]).variables, ""}
    with pytest.raises(ParameterError, match=r"in its attributes.*delete the attribute sha256"):
        files.read(path)
    with h5py.File(path, "a") as file:
        del file.attrs["sha256"]
    again = files.read(path)  # as a file of an older version
    assert again.attrs.pop("title") == "mine"
    xr.testing.assert_identical(
        again, results["cycle"].drop_attrs(deep=False).assign_attrs(again.attrs)
    )


def external_link(file, other):
    file["mu"] = h5py.ExternalLink(other, "/x")


def external_link_of_a_group(file, other):
    file["group/within"] = h5py.ExternalLink(other, "/")


def external_storage(file, other):
    file.create_dataset("mu", (3,), "f8", external=[(other, 0, h5py.h5f.UNLIMITED)])


def virtual(file, other):
    layout = h5py.VirtualLayout((3,), "f8")
    layout[:] = h5py.VirtualSource(other, "x", (3,))
    file.create_virtual_dataset("mu", layout)


@pytest.mark.parametrize(
    "make", [external_link, external_link_of_a_group, external_storage, virtual]
)
@pytest.mark.parametrize("reader", [raw_netcdf, read_hdf5])
def test_data_of_another_file_are_not_read(make, reader, tmp_path):
    other, path = tmp_path / "secret.h5", tmp_path / "x.nc"
    with h5py.File(other, "w") as file:
        file["x"] = np.arange(3.0)
    with h5py.File(path, "w") as file:
        file["time"] = file["displacement"] = np.arange(3.0)
        file["link"] = h5py.SoftLink("/time")  # within the file
        make(file, other.name)
    name = "group/within" if make is external_link_of_a_group else "mu"
    with pytest.raises(
        ParameterError, match=rf"{name}.* takes its data from .*secret\.h5"
    ) as error:
        reader(path)
    assert "x.nc is not read" in str(error.value)


def test_a_virtual_dataset_of_its_own_file_is_read(tmp_path):
    with h5py.File(tmp_path / "x.h5", "w") as file:
        file["time"] = file["x"] = np.arange(3.0)
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(".", "x", (3,))
        file.create_virtual_dataset("mu", layout)
    columns = {column.title: column.values for column in read_hdf5(tmp_path / "x.h5").columns}
    np.testing.assert_array_equal(columns["mu"], np.arange(3.0))


# Zarr folders that run code ------------------------------------------------------------------


class Payload:
    """Makes a folder when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def array_of_format_2(folder, ran):
    """Metadata of an array that is made in a folder, and unpickled by its codec when it is read."""
    codec = {"id": "pickle", "protocol": 5}
    form = {"zarr_format": 2, "shape": [1], "chunks": [1], "order": "C", "fill_value": None}
    form |= {"dtype": "|O", "compressor": codec, "filters": [{"id": "vlen-utf8"}]}
    folder.mkdir(parents=True)
    dimensions = {"_ARRAY_DIMENSIONS": ["x"]}
    for name, content in ((".zarray", form), (".zattrs", dimensions)):
        (folder / name).write_text(json.dumps(content))
    (folder / "0").write_bytes(pickle.dumps(Payload(ran)))
    return form | {"attributes": dimensions}


def all_of_format_2(path, ran):
    array_of_format_2(path / "x", ran)
    array_of_format_2(path / "sweep" / "done", ran)
    array_of_format_2(path / "sweep" / "inputs" / "x", ran)
    for group in (path, path / "sweep", path / "sweep" / "inputs"):
        (group / ".zgroup").write_text('{"zarr_format": 2}')
    attrs = {"function": "", "sizes": {}, "chunk": [], "device": "", "checksum": "", "versions": {}}
    (path / "sweep" / ".zattrs").write_text(json.dumps(attrs))


def listed_in_a_group_of_format_3(path, ran):
    nodes = {"x": array_of_format_2(path / "x", ran)}
    listed = {"kind": "inline", "must_understand": False, "metadata": nodes}
    group = {"zarr_format": 3, "node_type": "group", "attributes": {}}
    (path / "zarr.json").write_text(json.dumps(group | {"consolidated_metadata": listed}))


@pytest.mark.parametrize("make", [all_of_format_2, listed_in_a_group_of_format_3])
@pytest.mark.parametrize("reader", [files.read, store_status, open_result])
def test_zarr_format_2_is_refused_and_runs_no_code(make, reader, tmp_path, monkeypatch):
    def decode(codec, content, out=None):  # as numcodecs did before 0.16.6
        return pickle.loads(content)

    monkeypatch.setattr(numcodecs.pickles.Pickle, "decode", decode)
    path, ran = tmp_path / "x.zarr", tmp_path / "ran"
    make(path, ran)
    with warnings.catch_warnings(), contextlib.suppress(Exception):  # how others read it
        warnings.simplefilter("ignore")
        xr.open_zarr(path, chunks=None).load()
    ran.rmdir()
    with pytest.raises(StoreError, match=r"x\.zarr is in Zarr format 2"):
        reader(path)
    assert not ran.exists()


@pytest.mark.parametrize(
    "write",
    [
        lambda data: files.write(data, "a.nc"),
        files.csv_text,
        lambda data: files.laboratory_csv(data, "event"),
    ],
)
@pytest.mark.parametrize("data", [3, xr.DataArray(3.0)])
def test_only_datasets_are_written(write, data):
    with pytest.raises(ParameterError, match=f"a {type(data).__name__} is not a result"):
        write(data)
