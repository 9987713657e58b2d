"""Several files of one experiment as one record."""

import io
import json
import warnings

import h5py
import numpy as np
import pytest
from lab_files import HEADER, MU, N, T, X, write

import ratestate as rs
from ratestate.errors import RecordWarning

CUT = 50  # rows in the first of two files


@pytest.fixture
def whole(tmp_path):
    return rs.read_lab(write(tmp_path / "whole.txt", [T, X, MU, 20 + 0 * T]))


def same(data, whole, rtol=1e-12):
    for name in whole.variables:
        np.testing.assert_allclose(data[name], whole[name], rtol=rtol, atol=1e-9)


def notes(data):
    return json.loads(data.attrs["notes"])


def test_times_that_go_on(tmp_path, whole):
    columns = [T, X, MU, 20 + 0 * T]
    a = write(tmp_path / "a.txt", [c[:CUT] for c in columns])
    b = write(tmp_path / "b.txt", [c[CUT:90] for c in columns])
    c = write(tmp_path / "c.txt", [c[90:] for c in columns])
    data = rs.read_lab([a, b, c])  # warnings are errors
    same(data, whole, 0)
    assert data.attrs["source"] == "a.txt, b.txt, c.txt"
    assert notes(data) == []
    same(rs.read_lab((a, io.BytesIO(b.read_bytes()), c), join="absolute"), whole, 0)
    assert rs.read_lab([a]).sizes["time"] == CUT


def test_other_columns_and_units_in_each_file(tmp_path, whole):
    """In minutes and millimetres, in another order, in another format, without one column."""
    a = write(tmp_path / "a.txt", [T[:CUT], X[:CUT], MU[:CUT], 20 + 0 * T[:CUT]])
    header = "mu", "disp_mm", "Normal stress (bar)", "time [min]", "gouge (mg)"
    columns = [MU, X / 1e3, 200 + 0 * T, T / 60, 20 + T]
    b = write(tmp_path / "b.txt", [c[CUT:90] for c in columns], header)
    with h5py.File(tmp_path / "c.h5", "w") as file:
        for name, unit, column in (
            ("time", "ms", 1e3 * T),
            ("disp", "m", 1e-6 * X),
            ("mu", "", MU),
        ):
            file[name] = column[90:]
            file[name].attrs["units"] = unit
    same(rs.read_lab([a, b]), whole.isel(time=slice(0, 90)))
    with pytest.warns(RecordWarning, match=r"sigma is left out: a.txt has it, but c.h5 does not"):
        data = rs.read_lab([a, b, tmp_path / "c.h5"])
    same(data, whole.drop_vars("sigma"))
    v = write(tmp_path / "v.txt", [T, 1 + T, MU], ("Time(s)", "V_load (um/s)", "mu"))
    match = r"c.h5 has a column of delta_lp, but v.txt has none"
    with pytest.raises(rs.ParameterError, match=match):
        rs.read_lab([tmp_path / "c.h5", v])


def test_overlapping_times_name_the_rows(tmp_path):
    columns = [T + 100, X, MU, 20 + 0 * T]
    a = write(tmp_path / "a.txt", [c[:60] for c in columns])
    b = write(tmp_path / "b.txt", [c[CUT:] for c in columns])
    match = r"b.txt begins at 112.5 s \(line 2\), before the end of a.txt at 114.75 s \(line 61\)"
    with pytest.raises(rs.ParameterError, match=match):
        rs.read_lab([a, b])
    with pytest.raises(rs.ParameterError, match=r"a.txt begins at 100 s .* join='restart'"):
        rs.read_lab([b, a])
    # one row that both have is left out, by its line in the second
    b = write(tmp_path / "b.txt", [c[59:] for c in columns])
    with pytest.warns(
        RecordWarning, match=r"1 row is left out .* repeated: line 2 of b.txt \(114.75"
    ):
        data = rs.read_lab([a, b])
    np.testing.assert_array_equal(data.time, T + 100)


@pytest.mark.parametrize("first", [0.0, 0.25])
def test_clocks_that_begin_anew(tmp_path, whole, first):
    parts = [slice(0, CUT), slice(CUT, N)]
    a, b = (
        write(tmp_path / name, [T[part] - T[part][0] + first, X[part], MU[part], 20 + 0 * T[part]])
        for name, part in zip(("a.txt", "b.txt"), parts, strict=True)
    )
    with pytest.warns(RecordWarning, match=r"times of b.txt restart: 12.5 s are added"):
        data = rs.read_lab([a, b])
    same(data.assign_coords(time=data.time - first, segment_t=data.segment_t - first), whole)
    with pytest.raises(rs.ParameterError, match=r"join='restart' .*if the clock"):
        rs.read_lab([a, b], join="absolute")


def test_a_clock_is_not_taken_to_begin_anew_unless_all_begin_at_0(tmp_path, whole):
    columns = [T + 100, X, MU, 20 + 0 * T]
    a = write(tmp_path / "a.txt", [c[:CUT] for c in columns])
    b = write(tmp_path / "b.txt", [T[CUT:] - T[CUT], *(c[CUT:] for c in columns[1:])])
    with pytest.raises(rs.ParameterError, match=r"b\.txt begins at 0 s"):
        rs.read_lab([a, b])
    with pytest.warns(RecordWarning, match="restart: 112.5 s are added"):
        data = rs.read_lab([a, b], join="restart")
    np.testing.assert_allclose(data.delta_lp, whole.delta_lp, rtol=1e-12)
    np.testing.assert_allclose(data.segment_t, [100, 115], rtol=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_displacement_that_is_zeroed_with_the_clock(tmp_path, whole, sign):
    a = write(tmp_path / "a.txt", [T[:CUT], sign * X[:CUT], MU[:CUT]], HEADER[:3])
    columns = [T[CUT:] - T[CUT], sign * (X[CUT:] - X[CUT]), MU[CUT:]]
    b = write(tmp_path / "b.txt", columns, HEADER[:3])
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data = rs.read_lab([a, b])
    assert f"zero again in b.txt: {sign * 12.25:g} um are added" in str(caught[1].message)
    # what was moved between the files, 0.25 um, is not known
    np.testing.assert_allclose(data.delta_lp[CUT:], whole.delta_lp[CUT:] - 0.25e-6, atol=1e-12)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=0.02)


def test_a_gap_and_bad_rows_are_named_by_file(tmp_path):
    columns = [T, X, MU, 20 + 0 * T]
    a = write(tmp_path / "a.txt", [c[:40] for c in columns])
    b = write(tmp_path / "b.txt", [c[60:] for c in columns])
    b.write_text(b.read_text().replace(repr(float(MU[70])), "overload"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rs.read_lab([a, b])
    lost, gap = (str(one.message) for one in caught)
    assert "because a number is missing: line 12 of b.txt ('overload' in 'Fric" in lost
    assert "a gap in time before line 2 of b.txt (5.25 s)" in gap


@pytest.mark.parametrize(
    ("files", "keywords", "match"),
    [
        ([], {}, "no file is given"),
        (None, {"join": "first"}, "join = 'first' is unknown"),
        (["no.txt", "no.txt"], {}, "no.txt does not exist"),
        (None, {"joint": "auto"}, "read_lab has no parameter joint.* mean join"),
    ],
)
def test_wrong_arguments_for_joining_files_are_refused(tmp_path, files, keywords, match):
    path = write(tmp_path / "a.txt", [T, X, MU, 20 + 0 * T])
    with pytest.raises(rs.ParameterError, match=match):
        rs.read_lab([path] if files is None else files, **keywords)
