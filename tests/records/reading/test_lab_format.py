"""A laboratory's format as a file: written by `describe_lab`, read by `read_lab`, or refused."""

import json
import tomllib
import warnings

import lab_files
import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lab_files import MU, N, T, X

import ratestate as rs
from ratestate import describe_lab, read_lab
from ratestate.errors import RecordWarning
from ratestate.records.reading.lab_format import TABLES, read_lab_format

#: symbol -> values in SI
VALUES = {"time": T, "delta_lp": 1e-6 * X, "friction": MU, "tau": 2e7 * MU, "sigma": 2e7 + 0 * T}
#: symbol -> units, and SI in each
UNITS = {
    "time": {"s": 1.0, "min": 60.0, "ms": 1e-3},
    "delta_lp": {"um": 1e-6, "mm": 1e-3, "Mikron": 1e-6},
    "friction": {"": 1.0, "%": 0.01},
    "tau": {"MPa": 1e6, "N/mm²": 1e6, "bar": 1e5},
    "sigma": {"MPa": 1e6, "kgf/cm2": 98066.5, "Pa": 1.0},
}
#: how titles may look that say nothing, or too little
NAMES = st.text("abqyzäß時間\\\"'#=.Ω ", min_size=1, max_size=8).map(lambda x: f"q{x.strip()}z")


def write(path, header, columns, delimiter="\t", decimal="."):
    def number(x):
        return repr(x).replace(".", decimal)

    return lab_files.write(path, columns, header, number, delimiter=delimiter)


@st.composite
def tables(draw):
    """A file that nothing is known of by itself: titles, columns, options, delimiter, decimal."""
    stresses = draw(st.booleans())
    symbols = ["time", "delta_lp", *(["tau", "sigma"] if stresses else ["friction"])]
    constant = stresses and draw(st.booleans())
    if constant:
        symbols.remove("sigma")
    symbols = draw(st.permutations(symbols))
    header = draw(st.lists(NAMES, min_size=len(symbols), max_size=len(symbols)))
    columns, units, titles, values = {}, {}, [], []
    for place, (symbol, name) in enumerate(zip(symbols, header, strict=True), 1):
        unit = draw(st.sampled_from([*UNITS[symbol]]))
        beside = draw(st.booleans()) and unit
        titles.append(f"{name} [{unit}]" if beside else name)
        sign = draw(st.sampled_from([1, -1])) if symbol in ("delta_lp", "tau") else 1
        values.append(sign * VALUES[symbol] / UNITS[symbol][unit])
        if unit and not beside:
            units[symbol] = unit
        by_title = titles.count(titles[-1]) == 1 and draw(st.booleans())
        columns[symbol] = titles[-1] if by_title else place
    headless = all(isinstance(column, int) for column in columns.values()) and draw(st.booleans())
    if headless:
        chosen = dict(zip(symbols, [t.rpartition(" [")[2].rstrip("]") if "[" in t else ""
                                    for t in titles], strict=True))  # fmt: skip
        units |= {symbol: unit for symbol, unit in chosen.items() if unit}
    options = {"columns": columns, "units": units}
    if constant:
        options["sigma"] = draw(st.sampled_from(["20 MPa", 2e7, "200 bar"]))
    repeated = len(set(titles)) < len(titles)
    if repeated:  # a title that is repeated is none
        options["columns"] = {symbol: place for place, symbol in enumerate(symbols, 1)}
    delimiter = draw(st.sampled_from("\t;"))
    decimal = draw(st.sampled_from(".,"))
    return [] if headless else titles, values, options, delimiter, decimal


@given(table=tables())
@settings(max_examples=12, deadline=None,
          suppress_health_check=[HealthCheck.function_scoped_fixture])  # fmt: skip
def test_a_description_is_equivalent_to_its_options(tmp_path, table):
    header, values, options, delimiter, decimal = table
    path = write(tmp_path / "r.txt", header, values, delimiter, decimal)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        expected = read_lab(path, **options)
        text = describe_lab(path, **options)
        lab = tmp_path / "lab.toml"
        lab.write_text(text, "utf-8")
        data = read_lab(path, lab_format=lab)
        # signs are as described, and no longer looked for: only the words of the notes differ
        notes = [json.loads(one.attrs.pop("notes")) for one in (expected, data)]
        xr.testing.assert_identical(data, expected)
        assert len(notes[0]) == len(notes[1])
        again = describe_lab(path, lab_format=lab)
    assert tomllib.loads(again) == tomllib.loads(text)


def test_the_text_of_a_description(tmp_path):
    header = "Zeit [s]", "ch 1", "ch 2 (%)", "p"
    path = write(tmp_path / "r.txt", header, [T, -X, 100 * MU, 0 * T])
    text = describe_lab(path, {"delta_lp": 2, "friction": "ch 2"}, {"delta_lp": "um"},
                    sigma="20 MPa", K="5 GPa/m")  # fmt: skip
    assert tomllib.loads(text) == {
        "columns": {"time": "Zeit [s]", "delta_lp": "ch 1", "friction": "ch 2 (%)"},
        "units": {"delta_lp": "um"},
        "constants": {"sigma": "20 MPa"},
        "signs": {"delta_lp": -1},
        "machine": {"K": "5 GPa/m"},
    }
    assert '# time = "s"  # as in the file' in text
    assert '# M = "3000 kg/m^2"' in text
    # all that it leaves open stands there as a comment that may be used as it is
    whole = text.replace("# M", "M").replace("# [text]\n# delimiter", "[text]\ndelimiter")
    tables = tomllib.loads(whole.replace('# decimal = ","', 'decimal = "."'))
    assert tables.keys() == TABLES.keys()
    lab = tmp_path / "lab.toml"
    lab.write_text(text)
    data = read_lab(path, lab_format=lab)
    assert json.loads(data.attrs["machine"]) == {"K": "5 GPa/m"}
    np.testing.assert_allclose(data.sigma, 2e7)
    np.testing.assert_allclose(data.friction, MU)
    assert json.loads(data.attrs["columns"])["delta_lp"]["sign"] == -1


def test_arguments_override_the_lab_format(tmp_path):
    header = "Zeit [s]", "a", "b", "mu", "p (MPa)", "sigma (MPa)"
    columns = [T, X, 2 * X, MU, 0 * T, 30 + 0 * T]
    path = write(tmp_path / "r.txt", header, columns)
    lab = tmp_path / "lab.toml"
    lab.write_text('[columns]\ndelta_lp = "a"\nfriction = "mu"\nsigma = "sigma"\n'
                   '[units]\ndelta_lp = "um"\nsigma = "MPa"\n')  # fmt: skip
    data = read_lab(path, {"delta_lp": "b"}, {"delta_lp": "mm"}, lab_format=lab)
    np.testing.assert_allclose(data.delta_lp, 2e-3 * X)
    np.testing.assert_allclose(data.sigma, 3e7)
    with pytest.warns(RecordWarning, match=r"sigma = 20 MPa is given, so the column 'sigma"):
        data = read_lab(path, sigma="20 MPa", lab_format=lab)
    np.testing.assert_allclose(data.sigma, 2e7)
    assert "sigma" not in json.loads(data.attrs["columns"])
    lab.write_text('[columns]\ndelta_lp = "a"\n[units]\ndelta_lp = "um"\n[constants]\nsigma = 1e7')
    with pytest.raises(rs.ParameterError, match=r"sigma = 1.* and a column"):
        read_lab(path, {"sigma": 6}, lab_format=lab)


def test_signs_that_are_given_are_not_looked_for(tmp_path):
    path = write(tmp_path / "r.txt", ["t (s)", "disp (um)", "mu"], [T, -X, MU])
    lab = tmp_path / "lab.toml"
    lab.write_text("[signs]\ndelta_lp = -1")
    data = read_lab(path, lab_format=lab)
    np.testing.assert_allclose(data.delta_lp, 1e-6 * X, atol=1e-20)
    lab.write_text("[signs]\nfriction = 1")
    negative = write(tmp_path / "n.txt", ["t (s)", "disp (um)", "mu"], [T, X, -MU])
    np.testing.assert_array_equal(read_lab(negative, lab_format=lab).friction, -MU)
    np.testing.assert_array_equal(read_lab(negative).friction, MU)
    lab.write_text("[signs]\ndelta_lp = 1\nfriction = -1")
    with pytest.raises(rs.ParameterError, match="runs backwards"):
        read_lab(path, lab_format=lab)


def test_text_as_the_format_has_it(tmp_path):
    """Integers with a mark of decimals that looks like a delimiter, and the other way round."""
    rows = [f"{i},0,{i},5 {i % 7},{i}" for i in range(N)]
    path = tmp_path / "r.txt"
    path.write_text("\n".join(row.replace(",5", "") for row in rows))
    lab = tmp_path / "lab.toml"
    head = '[columns]\ntime = 1\ndelta_lp = 2\nfriction = 3\n[units]\ntime = "s"\ndelta_lp = "um"\n'
    lab.write_text(head + '[text]\ndelimiter = ","\n')
    with pytest.raises(rs.ParameterError):
        read_lab(path, lab_format=lab)  # of the cells "i 3" none is a number
    path.write_text("\n".join(f"{t:g},{t:g};{x:g},5;0,{i % 7 + 1}" for i, (t, x) in
                              enumerate(zip(range(N), range(N), strict=True))))  # fmt: skip
    lab.write_text(head + '[text]\ndelimiter = ";"\ndecimal = ","\n')
    data = read_lab(path, lab_format=lab)
    np.testing.assert_allclose(data.delta_lp, 1e-6 * (np.arange(N) + 0.5))
    np.testing.assert_allclose(data.friction, 0.1 * (np.arange(N) % 7 + 1))


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("[columns]\ntime = 0", r"lab.toml: \[columns\] time = 0 is not valid"),
        ("[columns]\ntme = 1", r"\[columns\] tme is unknown.* mean time\?"),
        ("[colums]\ntime = 1", r"\[colums\] is unknown.* mean columns\?"),
        ("columns = 3", r"lab.toml: columns is not a table"),
        ("[units]\ntime = 3", r"\[units\] time = 3 is not valid"),
        ("[units]\ndelta_lp = 'MPa'", r"\[units\] delta_lp = 'MPa' is not valid"),
        ("[constants]\nsigma = '20'", r"\[constants\] sigma = '20' is not valid"),
        ("[constants]\nsigma = -3", r"\[constants\] sigma = -3 is not valid"),
        ("[machine]\nK = '2 MN/m'", r"\[machine\] K = '2 MN/m' is not valid"),
        ("[machine]\nM = '2 m'", r"\[machine\] M = '2 m' is not valid"),
        ("[machine]\nL = 1", r"\[machine\] L is unknown"),
        ("[signs]\ndelta_lp = '-'", r"\[signs\] delta_lp = '-' is not valid"),
        ("[signs]\ndelta_lp = 0", r"\[signs\] delta_lp = 0 is not valid"),
        ("[signs]\ndelta_lp = true", r"\[signs\] delta_lp = True is not valid"),
        ("[signs]\ntime = -1", r"\[signs\] time is unknown"),
        ("[text]\ndelimiter = '|'", r"\[text\] delimiter = '\|' is not valid"),
        ("[text]\ndecimal = ';'", r"\[text\] decimal = ';' is not valid"),
        ("[text]\ndecimal = []", r"\[text\] decimal = \[\] is not valid"),
        ("[constants]\nsigma = 1e7\n[columns]\nsigma = 4", r"exclude each other"),
        ("[columns\n", r"lab.toml is not valid TOML"),
        ("#" * 100_001, "more than 100,000 bytes"),
    ],
)
def test_formats_refused(tmp_path, text, match):
    path = write(tmp_path / "r.txt", ["t (s)", "disp (um)", "mu"], [T, X, MU])
    lab = tmp_path / "lab.toml"
    lab.write_text(text)
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(path, lab_format=lab)


def test_all_that_is_wrong_with_a_format_is_reported(tmp_path):
    lab = tmp_path / "lab.toml"
    lab.write_text("[units]\ntime = 'm'\n[machine]\nK = 'x'\n[tables]\n")
    with pytest.raises(rs.ParameterError) as caught:
        read_lab_format(lab)
    lines = str(caught.value).splitlines()
    assert [line.partition("]")[0] for line in lines] == [
        f"lab.toml: [{table}" for table in ("units", "machine", "tables")
    ]


@pytest.mark.parametrize(
    ("keywords", "match"),
    [
        ({"K": "5 GPa"}, "K = '5 GPa' is not valid"),
        ({"M": "3 kg"}, "M = '3 kg' is not valid"),
        ({"sigma": "20 Pa"}, r"sigma = 20 Pa is impossible in a record"),
        ({"sigma": "20 m"}, "sigma = '20 m' is a length"),
        ({"lab_format": 3}, "lab_format = 3 is not a path"),
        ({"lab_format": "no.toml"}, "no.toml cannot be read: No such file"),
        ({"form": "x"}, "describe_lab has no parameter form"),
    ],
)
def test_descriptions_refused(tmp_path, keywords, match):
    path = write(tmp_path / "r.txt", ["t (s)", "disp (um)", "mu"], [T, X, MU])
    with pytest.raises(rs.ParameterError, match=match):
        describe_lab(path, **keywords)
