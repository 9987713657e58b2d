"""Records that are in memory: the same as from files, and by attempts of pages."""

import io
import threading
import time

import h5py
import pytest
import readers
import xarray as xr
from lab_files import MU, T, X

import ratestate as rs
from ratestate import ParameterError
from ratestate.records.kit.processes import read_isolated
from ratestate.records.reading.open_table import MemoryFile
from ratestate.records.reading.read import try_reading

COLUMNS = {"Time_s": T, "disp_um": X, "mu": MU}


def text(columns=COLUMNS):
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(repr, map(float, row))) for row in rows)])


def hdf5():
    stored = io.BytesIO()
    with h5py.File(stored, "w") as file:
        for name, column in COLUMNS.items():
            file[name] = column
    return stored.getvalue()


CONTENTS = {"r.csv": text().encode(), "r.h5": hdf5()}


def tried(name, contents, **choices):
    return try_reading(MemoryFile(name, contents), choices, seconds=60.0)


@pytest.mark.parametrize("name", ["r.csv", "r.h5"])
def test_contents_in_memory_are_read_as_their_file(name, tmp_path):
    path = tmp_path / name
    path.write_bytes(CONTENTS[name])
    expected = rs.read_lab(path)
    with path.open("rb") as file:
        xr.testing.assert_identical(rs.read_lab(file), expected)
    unnamed = rs.read_lab(io.BytesIO(CONTENTS[name]))
    xr.testing.assert_identical(unnamed.assign_attrs(source=name), expected)
    assert unnamed.attrs["source"] == "the file"


def test_an_attempt_has_the_record_of_read_lab(tmp_path):
    name = "r.csv"
    (tmp_path / name).write_bytes(CONTENTS[name])
    expected = rs.read_lab(tmp_path / name)
    found = tried(name, CONTENTS[name])
    assert found.error is None
    assert [unit for _, unit in found.columns] == (["s", "um", ""])
    assert found.chosen == {"time": 1, "delta_lp": 2, "friction": 3}
    xr.testing.assert_identical(found.record, expected)


def test_a_text_file_is_opened_as_binary():
    with pytest.raises(ParameterError, match="is neither a path nor a binary file"):
        rs.read_lab(io.StringIO("1 2"))


def test_an_attempt_that_fails_lists_the_columns():
    columns = dict(zip(("clock", "disp", "mu"), COLUMNS.values(), strict=True))
    found = tried("r.csv", text(columns).encode())
    assert found.columns == [("clock", ""), ("disp", ""), ("mu", "")]
    assert (found.chosen, found.record, found.error.sentence) == ({}, None, "columns.missing")
    found = tried("r.csv", text(columns).encode(), columns={"time": 1})
    assert found.chosen == {"time": 1, "delta_lp": 2, "friction": 3}
    assert found.error.sentence == "units.none"


def test_an_attempt_at_another_kind_of_file_has_an_error():
    found = tried("r.png", b"\x89PNG\r\n\x1a\n" + bytes(100))
    assert found[:3] == ([], {}, None)
    assert str(found.error).startswith("r.png is neither text nor HDF5 nor MAT")


def test_a_child_can_be_stopped():
    stop, begin = threading.Event(), time.monotonic()
    threading.Timer(0.3, stop.set).start()
    with pytest.raises(ParameterError, match="cannot be read as a thing: it was stopped"):
        read_isolated(readers.endless, MemoryFile("r", b""), "a thing", stop=stop)
    assert 0.3 < time.monotonic() - begin < 10.0


def test_a_child_process_ends_at_its_time_limit():
    with pytest.raises(ParameterError, match="it took more than 1 s"):
        read_isolated(readers.endless, MemoryFile("r", b""), "a thing", seconds=1.0)


def test_a_child_takes_a_file_larger_than_a_pipe():
    contents = bytes(range(256)) * 4096
    assert read_isolated(readers.checksum, MemoryFile("r", contents), "a thing", 7) == (
        sum(contents),
        7,
    )
