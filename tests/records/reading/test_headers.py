"""Headers of programs, and headers among the rows."""

import numpy as np
import pytest
from lab_files import MU, T, X

import ratestate as rs
from ratestate.errors import RecordWarning
from ratestate.records.reading import read_lab

COLUMNS = [T, X, 5 * MU, 5.0 + 0.0 * T]
TITLES = ["Time (s)", "LP disp (um)", "Shear stress (MPa)", "Normal stress (MPa)"]


def lines(columns, rows=slice(None), delimiter="\t"):
    return [
        delimiter.join(map(repr, row))
        for row in zip(*(c[rows].tolist() for c in columns), strict=True)
    ]


def check(data):
    np.testing.assert_allclose(data.time, T, rtol=1e-12)
    np.testing.assert_allclose(data.friction, MU)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5])


SWAPPED = [TITLES[0], TITLES[1], TITLES[3], TITLES[2]]


@pytest.mark.parametrize(
    ("second", "line"),
    [
        (["\t".join(SWAPPED)], 62),
        (["# " + "\t".join(SWAPPED)], 62),
        (["", "p12, second day", "\t".join(SWAPPED)], 64),
        (["\t".join([TITLES[0], "LP disp (mm)", *TITLES[2:]])], 62),
        (["Time\tLP disp\tShear stress\tNormal stress", "s\tum\tkPa\tMPa"], 62),
        (["s\tum\tkPa\tMPa"], 62),
        (["\t".join(TITLES[:3])], 62),
        (["\t".join([*TITLES, "Temperature"])], 62),
    ],
)
def test_another_header_among_the_rows_is_refused(tmp_path, second, line):
    path = tmp_path / "r.txt"
    rows = lines(COLUMNS)
    path.write_text("\n".join(["\t".join(TITLES), *rows[:60], *second, *rows[60:]]))
    with pytest.raises(rs.ParameterError, match=f"r.txt: line {line} is another header"):
        read_lab(path)


def test_another_order_of_names_that_mean_nothing_is_refused(tmp_path):
    path = tmp_path / "r.txt"
    rows = lines(COLUMNS)
    path.write_text("\n".join(["a\tb\tc\td", *rows[:60], "a\tb\td\tc", *rows[60:]]))
    with pytest.raises(rs.ParameterError, match=r"line 62 is another header, 'a\\tb\\td\\tc'"):
        read_lab(path, dict(zip(["time", "delta_lp", "tau", "sigma"], "abcd", strict=True)))


@pytest.mark.parametrize(
    ("between", "told"),
    [
        (["\t".join(TITLES)], True),
        (["Time (sec)\tLP disp (micron)\tShear stress (MPa)\tNormal stress (MPa)"], True),
        (["# pump stopped at 5 MPa"], False),
        (["", "# velocity 10 um/s", ""], False),
        (["overload\toverload\toverload\toverload"], True),
    ],
)
def test_the_same_header_and_remarks_among_the_rows_do_no_harm(tmp_path, between, told):
    path = tmp_path / "r.txt"
    rows = lines(COLUMNS)
    path.write_text("\n".join(["\t".join(TITLES), *rows[:60], *between, *rows[60:]]))
    if told:
        with pytest.warns(RecordWarning, match="because a number is missing: line 62"):
            check(read_lab(path))
    else:
        check(read_lab(path))


LABVIEW = """LabVIEW Measurement{d}
Writer_Version{d}2
Separator{d}Tab
Decimal_Separator{d}{mark}
X_Columns{d}{x}
Time_Pref{d}Relative
Date{d}2019/05/14
Time{d}12:00:00.123
***End_of_Header***{d}

Channels{d}3{d}{d}{d}
Samples{d}120{d}120{d}120{d}
Date{d}2019/05/14{d}2019/05/14{d}2019/05/14{d}
Y_Unit_Label{d}um{d}MPa{d}MPa{d}
X_Dimension{d}Time{d}Time{d}Time{d}
X0{d}0{mark}0E+0{d}0{mark}0E+0{d}0{mark}0E+0{d}
Delta_X{d}0{mark}250{d}0{mark}250{d}0{mark}250{d}
***End_of_Header***{d}{d}{d}{d}
X_Value{d}LP disp{d}Shear stress{d}Normal stress{d}Comment"""


@pytest.mark.parametrize("x", ["One", "No"])
@pytest.mark.parametrize(("d", "mark"), [("\t", "."), ("\t", ","), (",", ".")])
@pytest.mark.parametrize("comment", ["", None])
def test_a_file_of_labview(tmp_path, x, d, mark, comment):
    rows = [line.split("\t") for line in lines(COLUMNS)]
    rows = [["" if x == "No" else row[0], *row[1:]] for row in rows]
    text = [d.join(row + [comment] * (comment is not None)).replace(".", mark) for row in rows]
    path = tmp_path / "r.lvm"
    path.write_text("\n".join([LABVIEW.format(d=d, mark=mark, x=x), *text]))
    check(read_lab(path))


@pytest.mark.parametrize("tail", [";", ";;;", ";Remark"])
def test_columns_without_numbers_at_the_end(tmp_path, tail):
    path = tmp_path / "r.csv"
    rows = [f"{line}{';' * tail.count(';')}" for line in lines(COLUMNS, delimiter=";")]
    rows[50] += "ok" if "Remark" in tail else ""
    path.write_text("\n".join([";".join(TITLES) + tail, *rows]))
    check(read_lab(path))


def test_columns_with_few_numbers(tmp_path):
    rows = [line.split(",") for line in lines(COLUMNS, delimiter=",")]
    sparse = [[*row[:3], row[3] if i % 10 == 0 else ""] for i, row in enumerate(rows)]
    path = tmp_path / "r.csv"
    path.write_text("\n".join([",".join(TITLES), *map(",".join, sparse)]))
    match = r"'Normal stress \(MPa\)' \(sigma\) has a number in only 12 of 120 rows, .* in line 3"
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(path)
    titles = [*TITLES[:2], "Friction", TITLES[3]]
    beside = [[*row[:2], repr(mu), row[3]] for row, mu in zip(sparse, MU.tolist(), strict=True)]
    path.write_text("\n".join([",".join(titles), *map(",".join, beside)]))
    with pytest.warns(RecordWarning, match=r"sigma is left out: the column .* 12 of 120 rows"):
        check(read_lab(path))
    half = [
        [row[0], *(["", row[2]] if i % 2 else [row[1], ""]), row[3]] for i, row in enumerate(rows)
    ]
    path.write_text("\n".join([",".join(TITLES), *map(",".join, half)]))
    with pytest.raises(rs.ParameterError, match=r"only 60 of 120 rows, .* Only 0 rows have"):
        read_lab(path)
    most = [[*row[:3], row[3] if i % 2 or i > 100 else ""] for i, row in enumerate(rows)]
    path.write_text("\n".join([",".join(TITLES), *map(",".join, most)]))
    with pytest.warns(RecordWarning, match="51 rows are left out because a number is missing"):
        read_lab(path)
