"""Numbers as programs of other countries write them."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ratestate as rs
from ratestate.records.reading.cells import number_in
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
def test_numbers_come_back(tmp_path, style, delimiter, minus, numbers, quotes):
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
    np.testing.assert_array_equal([number_in(cell, "."), number_in(cell, ",")], [point, comma])


@pytest.mark.parametrize("mark", [",", "."])
def test_numbers_that_either_mark_explains_are_asked_for(tmp_path, mark):
    path = tmp_path / "r.txt"
    rows = [f"{1000 + i:,}\t{2000 + i * i:,}\t{6000 + i % 7:,}" for i in range(40)]
    path.write_text("\n".join(["Time (s)\tDisp (um)\tFriction", *rows]))
    with pytest.raises(rs.ParameterError, match=r"such as '1,000' may have a decimal comma"):
        read_text(path)
    values = read_text(path, decimal=mark).columns[0].values
    np.testing.assert_allclose(values, (1000 + np.arange(40)) / (1000.0 if mark == "," else 1.0))


@pytest.mark.parametrize(("first", "form"), [(900.5, ",.2f"), (10**6, ",.0f")])
def test_groups_of_digits(tmp_path, first, form):
    """They begin after the rows in which the decimal mark is found, or there are no decimals."""
    numbers = first + np.arange(400)
    path = tmp_path / "r.txt"
    path.write_text("\n".join(f"{i}\t{x:{form}}\t0.6" for i, x in enumerate(numbers)))
    np.testing.assert_array_equal(read_text(path).columns[1].values, numbers)
