"""Laboratory files as records: layouts, names, units, rows that cannot be used."""

import contextlib
import json
import os
import warnings

import h5py
import numpy as np
import pytest
import scipy.io
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lab_files import HEADER, MU, SIGMA, N, T, X, cells, check, write_rows
from paths import LAB

import ratestate as rs
from ratestate import files
from ratestate.errors import RecordWarning
from ratestate.records.reading import read_lab
from ratestate.records.reading.columns import Column, Table, choose_columns

COLUMNS = T, X, MU, SIGMA


def test_a_record_with_all_columns_is_read(tmp_path):
    data = read_lab(write_rows(tmp_path / "p1.txt", cells(COLUMNS)))
    check(data)
    assert set(data.sigma.values) == {2e7}
    np.testing.assert_allclose(data.segment_t, [0, 15], rtol=1e-12)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=1e-12)
    # displacements are multiples of 0.05 um: each of the two lines may be off by a part of it
    error = 0.05e-6 * (2 / 12) ** 0.5 / 9e-6
    np.testing.assert_allclose(data.segment_t_error, [0, error], rtol=0.05)
    assert (data.segment_V_error < 1e-12).all()
    assert data.attrs["title"] == "ratestate read_lab"
    assert data.attrs["source"] == "p1.txt"
    assert data.attrs["found"] == "velocity step 1 -> 10 um/s at 15 s (15 um)"
    assert json.loads(data.attrs["notes"]) == []
    columns = json.loads(data.attrs["columns"])
    assert columns["delta_lp"] == {"title": "Displ(microns)", "unit": "um"}
    assert columns["friction"] == {"title": "Friction", "unit": "1"}
    assert {v.attrs["units"] for v in data.variables.values()} == {"1", "m", "s", "Pa", "m/s"}
    again = files.read(files.write(data, tmp_path / "p1.nc"))
    xr.testing.assert_identical(again, data)


@pytest.mark.parametrize("unit", ["(s)", "(s )", ""])
def test_titles_between_blanks_are_words_and_their_brackets(unit, tmp_path):
    """A bracket belongs to the word before it, with or without blanks inside; a word does not."""
    header = f"Time {unit}", "Displ ( um )", "Friction", "Normal_stress [MPa]"
    units = {} if unit else {"time": "s"}
    data = read_lab(write_rows(tmp_path / "r.txt", cells(COLUMNS), header, " "), units=units)
    check(data)
    assert set(data.sigma.values) == {2e7}


def test_a_hold_is_named_with_its_length(tmp_path):
    x = np.where(T < 10, T, np.where(T < 18, 10.0, 30 * T - 530))
    data = read_lab(write_rows(tmp_path / "hold.txt", cells((T, x, MU, np.full(N, 20.0)))))
    hold = "hold of 8 s from 10 s (10 um); slide at 30 um/s from 18 s"
    assert data.attrs["found"].endswith(hold)


NAMES = st.fixed_dictionaries(
    {
        "time": st.sampled_from(["Time(s)", "time [s]", "TIME (sec)", "t_s", "Time, s", "t [s]"]),
        "x": st.sampled_from(
            ["Displ(microns)", "LPDisp [um]", "Load point displacement (\u00b5m)", "lp_disp_um"]
        ),
        "mu": st.sampled_from(["Friction", "mu", "COF", "mu [-]", "Friction coefficient"]),
        "sigma": st.sampled_from(["Normal_stress(MPa)", "Effective Normal stress [MPa]", "sn_MPa"]),
    }
)


@given(
    header=NAMES,
    order=st.permutations(range(4)),
    delimiter=st.sampled_from(["\t", ",", ";", "  ", ", ", " ; "]),
    end=st.sampled_from(["\n", "\r\n"]),
    bad=st.dictionaries(
        st.tuples(st.integers(1, N - 1), st.integers(0, 3)),
        st.sampled_from(["NaN", "x1", "-", "inf", "1.2.3", "1_0"]),
        max_size=8,
    ),
    comments=st.sets(st.integers(2, N - 2), max_size=3),
)
@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_headers_orders_delimiters_and_remarks_are_read(
    tmp_path, header, order, delimiter, end, bad, comments
):
    rows = cells(COLUMNS)
    for (row, column), text in bad.items():
        rows[row][column] = text
    lines = [[row[i] for i in order] for row in rows]
    for place in sorted(comments, reverse=True):
        lines.insert(place, ["# a remark"])
    spelled = [header["time x mu sigma".split()[i]] for i in order]
    if delimiter == ",":
        spelled = [f'"{name}"' for name in spelled]  # "Time, s" has a comma itself
    if delimiter == ", ":
        spelled = [name.replace(",", "") for name in spelled]
    path = write_rows(tmp_path / "r.txt", lines, spelled, delimiter, end=end)
    left = sorted(set(range(N)) - {row for row, _ in bad})
    with warnings.catch_warnings(record=True) as emitted:
        warnings.simplefilter("always")
        data = read_lab(path)
    check(data, left)
    assert set(data.sigma.values) == {2e7}
    dropped = sorted({row for row, _ in bad})
    texts = [str(one.message) for one in emitted if "number is missing" in str(one.message)]
    assert len(texts) == bool(dropped)
    if dropped:
        # as an editor counts: the header is line 1, and remarks are lines too
        number = [row + 2 + sum(place <= row for place in comments) for row in dropped]
        assert f"{len(dropped)} row" in texts[0]
        listed = [f"line {n}" for n in number[:5]]
        assert all(f"{one} (" in texts[0] for one in listed)
        assert (f"and {len(dropped) - 5} more" in texts[0]) == (len(dropped) > 5)
        assert texts[0].removeprefix("r.txt: ") in json.loads(data.attrs["notes"])


def test_the_surer_of_two_names_is_taken():
    row = np.arange(3.0)
    columns = "Time Displacement LP_disp Friction Normal_stress Effective_normal_stress".split()
    table = Table([Column(title, title, "", row) for title in columns])
    chosen = choose_columns(table, {})
    assert chosen == {"time": 0, "delta_lp": 2, "friction": 3, "sigma": 5}


def above_the_table():
    units = "s", "\u00b5m", "-", "MPa"
    plain = "Time", "Displacement", "Friction", "Normal stress"
    yield {"header": units, "above": ["\t".join(plain)]}  # units in a line of their own
    yield {"header": [f"({unit})" for unit in units], "above": ["p1234", "\t".join(plain)]}
    yield {"above": ["Experiment b819", "2019-05-14", "rate 10 Hz", ""]}
    yield {"above": ["2019 05 14"]}
    yield {"header": None, "above": ["# remark", "# " + "\t".join(HEADER)]}
    yield {"header": None, "above": ["% " + "  ".join(HEADER)], "delimiter": " "}
    yield {"header": [f"{name} ({unit})" for name, unit in zip(plain, units, strict=True)]}
    yield {"header": [*HEADER, ""]}  # a tab too many
    yield {"encoding": "utf-16"}
    yield {"encoding": "utf-8-sig", "end": "\r"}
    yield {"header": ("Time(s)", "Displ(\u00b5m)", "\u00b5", "sn_MPa"), "encoding": "cp1252"}


@pytest.mark.parametrize("how", [*above_the_table()])
def test_lines_above_the_table_and_encodings(tmp_path, how):
    data = read_lab(write_rows(tmp_path / "r.dat", cells(COLUMNS), **how))
    check(data)
    assert set(data.sigma.values) == {2e7}


def test_a_file_without_a_header_needs_columns_and_units(tmp_path):
    path = write_rows(tmp_path / "r.txt", cells(COLUMNS), None, ",")
    units = {"time": "s", "delta_lp": "um"}
    check(read_lab(path, {"time": 1, "delta_lp": 2, "friction": 3}, units))
    with pytest.raises(rs.ParameterError, match=r"no column is recognized as time.*'column 4'"):
        read_lab(path)


def test_columns_and_units_that_are_given(tmp_path):
    path = write_rows(tmp_path / "r.txt", cells(COLUMNS), ("a", "b (mm)", "c", "d(MPa)"))
    data = read_lab(path, {"time": "a", "delta_lp": "b", "friction": 3}, {"time": "min"})
    np.testing.assert_allclose(data.time, 60 * T)
    np.testing.assert_allclose(data.delta_lp, 1e-3 * X)
    assert "sigma" not in data
    data = read_lab(
        path, {"time": "a", "delta_lp": 2, "friction": "c", "sigma": "D"}, {"time": "s"}
    )
    assert float(data.sigma[0]) == 2e7


def in_groups(file):
    units = "s", "um", "", "MPa"
    keys = "time", "LP_disp", "friction", "normal_stress"
    for name, unit, column in zip(keys, units, COLUMNS, strict=True):
        file[f"run/{name}"] = column
        file[f"run/{name}"].attrs["units"] = unit
    file["run/remark"] = "said"


def as_compound(file):
    table = np.zeros(N, [("Time(s)", float), ("disp_um", "f8"), ("mu", "f8"), ("remark", "S3")])
    for name, column in zip(table.dtype.names, COLUMNS[:3], strict=False):
        table[name] = column
    file["table"] = table


def as_matrix(file):
    file["data"] = np.array(COLUMNS).T
    file["data"].attrs["columns"] = ["time", "displacement", "friction", "normal stress"]
    file["data"].attrs["units"] = ["s", "um", "1", "MPa"]


def packed(file):
    in_groups(file)
    del file["run/LP_disp"]
    file["run/LP_disp"] = np.round(X * 1000).astype("i4")
    file["run/LP_disp"].attrs.update({"units": "um", "scale_factor": 1e-3, "_FillValue": -9})


def matlab_7(file):
    for name, column in zip(("time_s", "disp_um", "mu"), COLUMNS, strict=False):
        file[name] = column.reshape(1, -1)
    file["name"] = np.array([[112, 49]], "u2")
    file["name"].attrs["MATLAB_class"] = np.bytes_("char")


@pytest.mark.parametrize("fill", [in_groups, as_compound, as_matrix, packed, matlab_7])
def test_hdf5(tmp_path, fill):
    with h5py.File(tmp_path / "r.h5", "w") as file:
        fill(file)
    check(read_lab(tmp_path / "r.h5"))


def test_hdf5_of_matlab_and_netcdf(tmp_path):
    with h5py.File(tmp_path / "r.mat", "w", userblock_size=512) as file:
        matlab_7(file)
    check(read_lab(tmp_path / "r.mat"))
    variables = {"delta_lp": ("time", X, {"units": "um"}), "friction": ("time", MU)}
    data = xr.Dataset(variables, {"time": ("time", T, {"units": "s"})})
    data.to_netcdf(tmp_path / "r.nc", engine="h5netcdf")
    check(read_lab(tmp_path / "r.nc"))
    read_lab(tmp_path / "r.nc").to_netcdf(tmp_path / "again.nc", engine="h5netcdf")
    xr.testing.assert_equal(read_lab(tmp_path / "again.nc"), read_lab(tmp_path / "r.nc"))


def test_mat(tmp_path):
    fields = dict(zip(("time", "lp_disp", "mu"), COLUMNS, strict=False))
    units = {"time": "s", "lp_disp": "um"}
    scipy.io.savemat(tmp_path / "a.mat", {"exp": fields | {"units": units, "name": "p1"}})
    scipy.io.savemat(tmp_path / "b.mat", {"Time_s": T, "disp_um": X[:, None], "mu": MU, "n": 3})
    scipy.io.savemat(tmp_path / "c.mat", {"data": np.array(COLUMNS).T})
    check(read_lab(tmp_path / "a.mat"))
    check(read_lab(tmp_path / "b.mat"))
    columns = {"time": "data[1]", "delta_lp": 2, "friction": 3}
    check(read_lab(tmp_path / "c.mat", columns, {"time": "s", "delta_lp": "um"}))


@pytest.mark.parametrize(("rows", "match"), [(1, "no columns of numbers"), (2, "only 2 rows")])
def test_a_single_number_in_a_stored_file_is_not_a_column(tmp_path, rows, match):
    scipy.io.savemat(tmp_path / "b.mat", {"Time_s": T[:rows], "disp_um": X[:rows], "mu": MU[:rows]})
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(tmp_path / "b.mat")


def test_rows_of_stored_files_count_from_1(tmp_path):
    mu = np.where(T == 1.0, np.nan, MU)
    scipy.io.savemat(tmp_path / "b.mat", {"Time_s": T, "disp_um": X, "mu": mu})
    with pytest.warns(RecordWarning, match=r"1 row is left out .*: row 5 \('nan' in 'mu'\)"):
        check(read_lab(tmp_path / "b.mat"), T != 1.0)


def refused(tmp_path, match, rows=None, header=HEADER, *arguments, **keywords):
    path = write_rows(tmp_path / "r.txt", cells(COLUMNS) if rows is None else rows, header)
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(path, *arguments, **keywords)


@pytest.mark.parametrize(
    ("header", "match"),
    [
        (
            ("Time", *HEADER[1:]),
            r"'Time' \(time\) has no unit. Give its unit, such as units={'time': 's'}",
        ),
        (("t(s)", "Displ(kN)", "mu", "s"), r"unit 'kN' of the column 'Displ\(kN\)' is .* another"),
        (("t(s)", "Displ(V)", "mu", "s"), r"unit 'V' of the column 'Displ\(V\)' .* another col"),
        (("t(s)", "Disp(um)", "Shear (kN)", "sigma(MPa)"), "whole contact.* divided by its area"),
        (("t(s)", "Disp(furlog)", "mu", "s"), "'furlog'.* unknown unit"),
        (("t(s)", "Disp(km)", "mu", "s"), r"'Disp\(km\)' \(delta_lp\) spans .* impossible"),
        (("t(s)", "Disp(um)", "mu", "sn(Pa)"), r"'sn\(Pa\)' \(sigma\) is typically 20 Pa"),
        (("t(s)", "mu", "Disp(um)", "sigma"), r"'mu' \(friction\) is typically .* per cent"),
        (("t(s)", "Disp A(um)", "Disp B(um)", "mu"), "delta_lp may be any of .*'Disp A.*columns="),
        (("t(s)", "slip(um)", "mu", "sigma"), r"no column is recognized as delta_lp.*'slip\(um\)'"),
        (("t(s)", "Disp(um)", "x", "sigma(MPa)"), "no column is recognized as friction, or tau"),
        (("t(s)", "Disp(um)", "tau(MPa)", "x"), "no column is recognized as sigma, to go with tau"),
        (("t(s)", "Disp(um)", "mu"), "3 names for 4 columns .line 2 has 4 numbers"),
    ],
)
def test_headers_refused(tmp_path, header, match):
    refused(tmp_path, match, None, header)


def test_wrong_columns_and_units_are_refused(tmp_path):
    for columns, match in [
        ({"time": "Tme(s)"}, r"'Tme\(s\)' is not a column.* mean 'Time\(s\)'"),
        ({"time": 5}, "time = 5 is not a column"),
        ({"t": 1}, "columns must name some of time, delta_lp"),
        ({"time": 1.0}, "neither a title nor a number"),
        ([1, 2], "columns must name"),
    ]:
        refused(tmp_path, match, None, HEADER, columns)
    for units, match in [
        ({"delta_lp": "MPa"}, r"units: delta_lp = 'MPa' of the column 'Displ.* is a stress"),
        ({"tau": "MPa"}, "units: tau is not among the columns"),
        ("um", "units = 'um' must be a dict of texts"),
    ]:
        refused(tmp_path, match, None, HEADER, None, units)
    for window, match in [
        ({"time": ("1 m", None)}, r"time \(from\) = '1 m' is a length"),
        ({"time": 3}, "time = 3 is not a pair"),
        ({"time": (3, 2)}, "increasing order"),
        ({"time": (1000, None)}, "no row lies in the window. The record extends from 0 s to 29.75"),
        ({"time": (3, 4)}, "only 5 rows are left in the window"),
        ({"displacement": ("1 mm", "2 mm")}, "displacement: no row lies in the window"),
    ]:
        refused(tmp_path, match, None, HEADER, **window)


def test_files_refused(tmp_path):
    path = tmp_path / "r.dat"
    for content, match in [
        (b"", "r.dat is empty"),
        (b"# nothing\n\n", "is empty|no line of numbers"),
        (b"Time(s)\tmu\n", "has no line of numbers"),
        (b"Time(s)\tDispl(um)\tmu\n1\t2\t0.6\n", "has a single row of numbers"),
        (b"a\0b", "neither text nor HDF5"),
        (b"PK\x03\x04rest", "a spreadsheet"),
        (b"\x89HDF\r\n\x1a\nbroken", "cannot be read as HDF5"),
        (b"MATLAB 5.0 broken", "cannot be read as a MAT"),
    ]:
        path.write_bytes(content)
        with pytest.raises(rs.ParameterError, match=match):
            read_lab(path)
    for missing, match in [(tmp_path / "no", "does not exist"), (tmp_path, "folder"), (3, "path")]:
        with pytest.raises(rs.ParameterError, match=match):
            read_lab(missing)
    with h5py.File(tmp_path / "r.h5", "w") as file:
        file["n"] = 3
    with pytest.raises(rs.ParameterError, match="no columns of numbers"):
        read_lab(tmp_path / "r.h5")
    with h5py.File(tmp_path / "r.h5", "w") as file:
        in_groups(file)
        del file["run/friction"]
        file["run/friction"] = MU[:-1]
    with pytest.raises(rs.ParameterError, match=r"numbers of rows: .*'run/friction' has 119"):
        read_lab(tmp_path / "r.h5")


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ((T, X, MU), ""),
        ((T, X, MU / 6.2), "friction is 0.097"),
        ((T, X, MU / 5.8), ""),
        ((T, X, 1.9 * MU), ""),
        ((T, X, 2.1 * MU), "friction is 1.26"),
        ((T, 5e3 * X, MU), ""),
        ((T, 7e3 * X, MU), "delta_lp spans 1.14 m, farther than 1 m"),
        ((T / 9e3, X, MU), ""),
        ((T / 2e4, X, MU), "moves at up to 200 mm/s, faster than 0.1 m/s"),
    ],
)
def test_sizes_that_few_experiments_have_are_noted(tmp_path, columns, words):
    columns = (*columns[:2], columns[2] + 1e-6 * np.sin(T))
    path = write_rows(tmp_path / "r.txt", cells(columns), HEADER[:3])
    with pytest.warns(RecordWarning, match=words) if words else contextlib.nullcontext():
        notes = read_lab(path).attrs["notes"]
    assert words in notes
    assert notes == "[]" if not words else len(json.loads(notes)) == 1


@pytest.mark.parametrize("sigma", [0.9e-3, 1.1e-3, 999.0, 1001.0])
def test_a_normal_stress_that_few_machines_reach_is_reported(tmp_path, sigma):
    """Outside 1 kPa to 1 GPa."""
    path = write_rows(tmp_path / "r.txt", cells((T, X, MU, sigma + 0 * T)))
    told = pytest.warns(RecordWarning, match=r"sigma is .* \(its median\), which few machines")
    with contextlib.nullcontext() if 1e-3 < sigma < 1e3 else told:
        read_lab(path)


@pytest.mark.parametrize(("wanders", "noted"), [(0.0, False), (0.05, True)])
def test_rounding_of_the_load_point_is_not_reported_as_wander(tmp_path, wanders, noted):
    """Displacement to 0.01 um: by 0.5 um a row, and from a step on by 1.2345 um."""
    rows = np.arange(600)
    x = 0.5 * rows + 0.7345 * np.maximum(rows - 400, 0) + wanders * np.sin(rows / 60.0)
    t, x = 0.5 * rows, np.round(x, 6 if wanders else 2)
    columns = (t, x, 0.6 + 0.003 * np.sin(t))
    notes = read_lab(write_rows(tmp_path / "r.txt", cells(columns), HEADER[:3])).attrs["notes"]
    assert ("wanders about constant speeds" in notes) == noted


def test_rows_that_are_never_as_long_as_the_next_are_refused(tmp_path):
    rows = [row if i % 2 else row[:2] for i, row in enumerate(cells(COLUMNS))]
    with pytest.raises(
        rs.ParameterError, match=r"has no line of numbers .* followed by a line with equally many"
    ):
        read_lab(write_rows(tmp_path / "r.txt", rows))


def test_texts_that_are_too_long_are_refused(tmp_path, monkeypatch):
    path = tmp_path / "r.txt"
    for content, match in [
        ("1," * 300_000 + "\n", "r.txt is not a record: line 1 has 600,000 characters"),
        ("\n" + "x" * 20_001 + "\n1\t2\n", "line 2 has 20,001 characters, more than 20,000"),
        ("one word\n" * 10_000, "no line of numbers"),
    ]:
        path.write_text(content)
        with pytest.raises(rs.ParameterError, match=match):
            read_lab(path)
    check(read_lab(write_rows(path, cells(COLUMNS), above=["#" + "x" * 19_999, *["#"] * 1000])))
    size = path.stat().st_size
    monkeypatch.setattr("ratestate.records.reading.text.MAX_BYTES", size)
    check(read_lab(path))
    monkeypatch.setattr("ratestate.records.reading.text.MAX_BYTES", size - 1)
    with pytest.raises(rs.ParameterError, match=r"that are read as text\. Save it as HDF5"):
        read_lab(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes that have names")
def test_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.txt")
    with pytest.raises(rs.ParameterError, match=r"pipe.txt is not a regular file"):
        read_lab(tmp_path / "pipe.txt")


def test_friction_that_is_next_to_nothing_most_of_the_time(tmp_path):
    """A record that begins long before it is loaded; and one that is in another unit throughout."""
    late = np.where(np.arange(N) < 0.8 * N, 1e-5, 1.0) * MU
    path = write_rows(tmp_path / "r.txt", cells([T, X, late]), HEADER[:3])
    with pytest.warns(RecordWarning, match=r"friction is 6.02e-06 \(its median\)"):
        check(read_lab(path), friction=late)
    never = np.where(np.arange(N) < 0.95 * N, 1e-5, 1.0) * MU
    match = r"'Friction' \(friction\) is typically 6.* impossible in a record"
    refused(tmp_path, match, cells([T, X, never]), HEADER[:3])


def test_dead_channels_and_short_records(tmp_path):
    for dead in (1, 2):
        columns = [*COLUMNS]
        columns[dead] = np.full(N, 0.5)
        refused(tmp_path, rf"'{HEADER[dead][:5]}.* all 120 rows, as if its sensor", cells(columns))
    refused(tmp_path, "only 9 rows are left", cells(COLUMNS)[:9])


def test_times_that_repeat_or_run_backwards(tmp_path):
    rows = cells(COLUMNS)
    path = write_rows(tmp_path / "r.txt", [*rows[:8], rows[7], rows[7], *rows[8:]])
    with pytest.warns(RecordWarning, match=r"2 rows are left out .* repeated: line 10 \(1.75 s\)"):
        check(read_lab(path))
    match = r"backwards at line 62, first from 14.75 s to 0 s. Sort .*time=\(None, '14.75 s'\)"
    refused(tmp_path, match, rows[:60] + rows[:30])
    check(read_lab(write_rows(tmp_path / "r.txt", [*rows, rows[0]]), time=(1, 29)), slice(4, 117))


def test_times_that_are_one_but_for_rounding(tmp_path):
    """A step of 1e-9 of the usual one is none, and one of 1e-8 is."""
    for step, rows in ((0.25e-9, T != 0.25), (0.25e-8, slice(None))):
        t = np.where(T == 0.25, step, T)
        path = write_rows(tmp_path / "r.txt", cells((t, *COLUMNS[1:])))
        with warnings.catch_warnings(record=True) as emitted:
            warnings.simplefilter("always")
            data = read_lab(path)
        np.testing.assert_array_equal(data.time, t[rows])
        left_out = [str(one.message) for one in emitted if "the time is repeated" in str(one)]
        assert len(left_out) == (step < 1e-9)


def test_gaps_in_time_are_reported_and_steps_kept(tmp_path):
    rows = cells(COLUMNS)
    path = write_rows(tmp_path / "r.txt", rows[:20] + rows[30:90] + rows[100:])
    with pytest.warns(RecordWarning, match=r"2 gaps in time before line 22 \(2.75 s\), line 82 "):
        data = read_lab(path)
    np.testing.assert_allclose(data.segment_t, [0, 15], rtol=1e-12)


@pytest.mark.parametrize("rates", [(0.1, 0.01), (0.01, 0.1), (1.0, 0.001)])
def test_a_change_of_rate_is_not_a_gap(tmp_path, rates):
    before, after = (np.arange(200) * dt for dt in rates)
    t = np.append(before, before[-1] + rates[1] + after)
    x = np.interp(t, [0, before[-1], t[-1]], [0, 50, 400])
    mu = 0.6 + 1e-3 * np.sin(np.arange(400))
    data = read_lab(write_rows(tmp_path / "r.txt", cells([t, x, mu]), HEADER[:3]))
    assert data.sizes["segment"] == 2


def test_windows(tmp_path):
    path = write_rows(tmp_path / "r.txt", cells(COLUMNS))
    check(read_lab(path, time=("10 s", "20000 ms")), slice(40, 81))
    check(read_lab(path, time=(10, None)), slice(40, None))
    check(read_lab(path, displacement=("10 um", "65 um")), slice(40, 81))
    check(read_lab(path, displacement=(None, 65e-6), time=(10, None)), slice(40, 81))
    data = read_lab(path, time=(None, "10 s"))
    assert data.attrs["found"] == "no step: steady at 1 um/s throughout"
    # what lies outside the window does no harm
    rows = cells(COLUMNS)
    rows[100][2] = "bad"
    check(read_lab(write_rows(tmp_path / "r.txt", rows), time=("10 s", "20 s")), slice(40, 81))


def test_a_load_point_that_runs_downwards(tmp_path):
    path = write_rows(tmp_path / "r.txt", cells([T, 1000 - X, MU]), HEADER[:3])
    data = read_lab(path)
    np.testing.assert_allclose(data.delta_lp, 1e-6 * (X - 1000), rtol=1e-12)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=1e-9)
    assert "runs downwards, so its sign is changed" in data.attrs["notes"]
    assert "(-985 um)" in data.attrs["found"]
    data = read_lab(path, displacement=("935 um", "990 um"))  # as the file has it
    assert data.sizes["time"] == 41


def test_velocity_and_stresses_for_displacement_and_friction(tmp_path):
    V = np.where(T < 15, -2.0, np.where(T < 20, 0.0, -30.0))
    header = "t (s)", "Velocity [um/s]", "Shear stress, MPa", "Normal stress, MPa"
    data = read_lab(write_rows(tmp_path / "r.txt", cells([T, V, 20 * MU, 20 + 0 * T]), header))
    np.testing.assert_allclose(data.friction, MU, rtol=1e-12)
    np.testing.assert_allclose(data.tau, 2e7 * MU, rtol=1e-12)
    np.testing.assert_allclose(data.segment_V, [2e-6, 0, 3e-5], rtol=1e-9, atol=0)
    np.testing.assert_allclose(data.segment_t, [0, 14.875, 19.875])
    assert "delta_lp" not in data
    assert data.attrs["found"] == "hold of 5 s from 14.88 s; slide at 30 um/s from 19.88 s"
    assert "V_load runs downwards" in data.attrs["notes"]


def test_columns_that_do_not_agree_or_have_no_unit(tmp_path):
    header = "t (s)", "disp (um)", "mu", "sigma (MPa)", "tau (MPa)"
    path = write_rows(tmp_path / "r.txt", cells([*COLUMNS, 2 * MU]), header)
    with pytest.warns(RecordWarning, match=r"tau/sigma is 0.1 times the recorded friction"):
        check(read_lab(path))
    path = write_rows(tmp_path / "r.txt", cells(COLUMNS), (*HEADER[:3], "Normal stress"))
    with pytest.warns(RecordWarning, match="sigma is left out: .*'Normal stress'.* has no unit"):
        assert "sigma" not in read_lab(path)
    with pytest.raises(rs.ParameterError, match="has no unit"):
        read_lab(path, {"sigma": 4})


def real(name):
    if not (LAB / name).exists():
        pytest.skip("the records are not here")
    return LAB / name


def test_basalt():
    data = read_lab(real("velstep4_BRAVA_expb819_basalt.txt"))  # warnings are errors
    assert data.sizes == {"time": 5849, "segment": 2}
    np.testing.assert_allclose(data.segment_V, [3e-6, 1e-5], rtol=0.002)
    # friction begins to rise there; the jumps of the displacement would move a global fit by 0.3 s
    assert abs(float(data.segment_t[1]) - 11676.38) < 0.02
    assert data.attrs["found"] == "velocity step 3 -> 10 um/s at 11676.4 s (8711 um)"
    notes = json.loads(data.attrs["notes"])
    assert [note.partition(" at ")[0] for note in notes] == [
        "delta_lp jumps by 901 nm",
        *["delta_lp jumps by 1.05 um", "delta_lp jumps by 1.04 um", "delta_lp jumps by 1.05 um"],
    ]


def test_sepiolite():
    data = read_lab(real("velstep3_TR2_exp013_sepiolite.txt"))
    assert data.sizes == {"time": 16466, "segment": 2}
    np.testing.assert_allclose(data.segment_V, [2e-7, 2e-6], rtol=0.001)
    assert abs(float(data.segment_t[1]) - 21320.9) < 0.1
    assert json.loads(data.attrs["notes"]) == []
    assert json.loads(data.attrs["columns"])["sigma"]["title"] == "Effective_Normal_stress(MPa)"
