"""Numbers and clock times as programs of other countries write them."""

import datetime

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate.records.reading import read_lab
from ratestate.records.reading.cells import detect_clock, parse_number
from ratestate.records.reading.text import read_text

#: decimal mark, what stands between groups of three digits
STYLES = [(".", ""), (".", ","), (".", " "), (".", "'"), (".", "\u202f"), (",", ""), (",", "."),
          (",", " "), (",", "\u00a0")]  # fmt: skip


def written(number, decimal, group, minus):
    text = f"{number:,.3f}".replace(",", "_").replace(".", decimal).replace("_", group)
    return text.replace("-", minus)


@given(
    style=st.sampled_from(STYLES),
    delimiter=st.sampled_from("\t;,"),
    minus=st.sampled_from(["-", "\u2212", "\uff0d"]),
    numbers=st.lists(
        st.tuples(*[st.integers(-(10**10), 10**10) for _ in range(3)]), min_size=3, max_size=40
    ),
    quotes=st.booleans(),
)
@settings(max_examples=80, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_written_numbers_are_read_again_exactly(tmp_path, style, delimiter, minus, numbers, quotes):
    values = np.array(numbers) / 1000.0
    values[0] = 0.25, 1250.75, -0.5  # so that it is clear what is what
    quotes = quotes or delimiter == ","
    rows = [
        delimiter.join(
            f'"{text}"' if quotes else text for x in row if (text := written(x, *style, minus))
        )
        for row in values.tolist()
    ]
    path = tmp_path / "r.txt"
    path.write_text("\n".join([delimiter.join("abc"), *rows]), "utf-8")
    table = read_text(path)
    np.testing.assert_array_equal(np.transpose([c.values for c in table.columns]), values)


@pytest.mark.parametrize(
    ("cell", "point", "comma"),
    [
        ("1,234", 1234.0, 1.234),
        ("1.234", 1.234, 1234.0),
        ("1,234.5", 1234.5, np.nan),
        ("1.234,5", np.nan, 1234.5),
        ("0,123", np.nan, 0.123),
        ("12,34", np.nan, 12.34),
        ("1,234,567", 1234567.0, np.nan),
        ("1'234'567,5", np.nan, 1234567.5),
        ("-1 234", -1234.0, -1234.0),
        ("1 234,567", np.nan, 1234.567),
        ("1_000", np.nan, np.nan),
        ("12:30", np.nan, np.nan),
    ],
)
def test_a_number_with_either_decimal_mark(cell, point, comma):
    np.testing.assert_array_equal(
        [parse_number(cell, "."), parse_number(cell, ",")], [point, comma]
    )


@pytest.mark.parametrize("mark", [",", "."])
def test_numbers_with_an_ambiguous_decimal_mark_are_refused(tmp_path, mark):
    path = tmp_path / "r.txt"
    rows = [f"{1000 + i:,}\t{2000 + i * i:,}\t{6000 + i % 7:,}" for i in range(40)]
    path.write_text("\n".join(["Time (s)\tDisp (um)\tFriction", *rows]))
    with pytest.raises(rs.ParameterError, match=r"such as '1,000' may have a decimal comma"):
        read_text(path)
    values = read_text(path, decimal=mark).columns[0].values
    np.testing.assert_allclose(values, (1000 + np.arange(40)) / (1000.0 if mark == "," else 1.0))


#: forms of strftime that say a time to the microsecond, without a date or with one
ALONE = ["%H:%M:%S.%f", "%I:%M:%S.%f %p", "%H:%M:%S,%f", "%H:%M:%S:%f"]
DATED = [
    "%Y-%m-%dT%H:%M:%S.%fZ",
    "%Y/%m/%d %H:%M:%S.%f",
    "%d.%m.%Y %H:%M:%S,%f",
    "%d-%b-%Y %H:%M:%S.%f",
    "%m/%d/%Y %I:%M:%S.%f %p",
    "%d/%m/%Y %H:%M:%S.%f",
    "%m/%d/%y %H:%M:%S.%f",
]


def seconds(cells, unit=""):
    clock = detect_clock(cells[0], unit)
    return clock.continuous(clock.seconds(cells))


@given(
    start=st.datetimes(datetime.datetime(2000, 1, 1), datetime.datetime(2040, 1, 1)),
    form=st.sampled_from(ALONE + DATED),
    steps=st.lists(st.integers(1, 3 * 3_600 * 10**6), min_size=2, max_size=30),
)
def test_times_come_back_from_any_form(start, form, steps):
    """Across midnight, the ends of months and of years; whether the day or the month is first."""
    after = np.cumsum([0, *steps])
    cells = [(start + datetime.timedelta(microseconds=int(us))).strftime(form) for us in after]
    found = seconds(cells)
    np.testing.assert_allclose(found - found[0], after / 1e6, rtol=0, atol=2e-6)
    of_day = start - start.replace(hour=0, minute=0, second=0, microsecond=0)
    assert abs(found[0] - of_day.total_seconds()) < 2e-6 or "/" in form


@pytest.mark.parametrize(
    ("cells", "unit", "expected"),
    [
        (["59:59.5", "00:00.5"], "", [3599.5, 3600.5]),
        (["00:59", "01:01"], "(mm:ss)", [59.0, 61.0]),
        (["00:59", "01:01"], "hh:mm", [3540.0, 3660.0]),
        (["71:59:59", "72:00:01"], "", [259199.0, 259201.0]),
        (["1 23:59:59.5", "2 00:00:00.5"], "", [86399.5, 86400.5]),
        (["11:59:59 PM", "12:00:01 AM"], "", [86399.0, 86401.0]),
        (["12:00:00", "--:--:--", "12:00:02"], "", [43200.0, np.nan, 43202.0]),
        # years come first: not 1 May and 1 June, or a day apart
        (["2024-01-05 12:00:00", "2024-02-05 12:00:00"], "", [43200.0, 43200.0 + 31 * 86400.0]),
    ],
)
def test_times_of_other_forms(cells, unit, expected):
    np.testing.assert_array_equal(seconds(cells, unit), expected)


@pytest.mark.parametrize("cell", ["12:30", "0.25", "", "run 3", "2019-05-14", "a:b:c", "1:2:3"])
def test_other_cells_are_not_clock_times(cell):
    assert detect_clock(cell) is None


@pytest.mark.parametrize("clock", ["Time", "Timestamp", "Date/Time", "Uhrzeit"])
def test_seconds_beside_a_clock_are_read(tmp_path, clock):
    """The clock has whole seconds: of ten rows nine would have the time of the row before."""
    t = np.arange(300) * 0.1
    rows = [
        f"12:00:{int(s):02d},{s:.1f},{s if s < 15 else 10 * s - 135:.4f},{0.6 + 0.01 * np.sin(s)}"
        for s in t.tolist()
    ]
    path = tmp_path / "r.csv"
    path.write_text("\n".join([f"{clock},Elapsed time (s),Disp (um),Friction", *rows]))
    data = read_lab(path)
    np.testing.assert_allclose(data.time, t)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5], rtol=1e-6)


@pytest.mark.parametrize("form", ["%Y-%m-%d", "%d.%m.%Y", "%m/%d/%Y"])
def test_a_date_and_a_clock_time_beside_two_columns(tmp_path, form):
    """As many cells are numbers as are none; the record goes on past midnight."""
    start, rows = datetime.datetime(2024, 3, 1, 23, 59), ["Date,Time,Displacement (um),Friction"]
    for i in range(200):
        now = start + datetime.timedelta(seconds=i)
        rows.append(now.strftime(f"{form},%H:%M:%S,{5 * i},0.6{i:03d}"))
    path = tmp_path / "r.csv"
    path.write_text("\n".join(rows) + "\n")
    np.testing.assert_array_equal(np.diff(read_lab(path).time), 1.0)
