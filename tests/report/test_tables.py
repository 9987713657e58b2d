"""Tables of results in terminals of any width."""

import re

import numpy as np
import pytest
import xarray as xr
from rich.console import Console

import ratestate as rs
from ratestate.report.report import Heading, TextTable, left

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc=1e-5, sigma=2e6, K=9e8, M=3e3)


def printed(what, width):
    console = Console(width=width, legacy_windows=False)
    with console.capture() as text:
        console.print(*what, sep="\n")
    return text.get().splitlines()


@pytest.fixture(scope="module")
def sweep():
    V_lp = rs.logspace("V_lp", 1e-3, 1e-1, 7)
    slider = SLIDER.replace(M=rs.logspace("M", 1e2, 1e5, 5))
    return rs.sweep("limit_cycle", slider, V_lp=V_lp, progress=False)


@pytest.fixture(scope="module")
def cycle():
    return rs.limit_cycle(SLIDER, 1e-2)


@pytest.mark.parametrize("width", [80, 100, 140])
def test_a_sweep_s_places_are_never_wrapped(sweep, width):
    lines = printed(rs.summary(sweep), width)
    rows = [line for line in lines[3:] if " = " in line]
    beside = width == 140
    assert len(rows) == (8 if beside else 16)
    for line in rows:
        assert line.count(" = ") == (4 if beside else 2), line
        assert len(line) <= width
    most = sweep.amplitude.where(sweep.amplitude == sweep.amplitude.max(), drop=True)
    row = rows[0 if beside else 8].rstrip()
    assert f"{float(most.max()):.6g}" in row
    assert row.endswith(f"V_lp = {1e3 * float(most.V_lp[0]):.6g} mm/s")


def test_a_critical_velocity_of_zero_is_told_in_words():
    K_c = float(rs.stability(SLIDER.replace(M=0.0), 1e-2).K_c_qs)
    slider = SLIDER.replace(K=xr.DataArray([0.5 * K_c, 1.5 * K_c], dims="K"))
    result = rs.sweep("stability", slider, V_lp=1e-2, progress=False)
    lines = printed(rs.summary(result, {"V_c": "mm/s"}), 140)
    row = next(line for line in lines if line.startswith("V_c "))
    finite = f"{1e3 * float(result.V_c[1]):.6g} mm/s"
    assert result.V_c[0] == 0.0 < result.V_c[1]
    cells = [cell.strip() for cell in row.split("  ") if cell.strip()]
    assert cells[1::2] == ["unstable at any speed", finite]


@pytest.mark.parametrize("width", [80, 100])
def test_text_beside_errors_has_room(cycle, width):
    lines = printed(rs.summary(cycle), width)
    head, value = (next(line for line in lines if name in line) for name in ("relative", "value"))
    assert head.split() + value.split() == ["relative", "value", "error"]
    period = next(line for line in lines if line.startswith("period"))
    assert width - period.index("period of the limit cycle") >= 30 + width - 80
    assert max(map(len, lines)) <= width


@pytest.mark.parametrize(("width", "tables"), [(80, 2), (100, 1)])
def test_points_of_a_branch_are_on_a_line_each(width, tables):
    branch = rs.continue_cycle(SLIDER, "V_lp", 5e-3, 3e-3, rtol=1e-6)
    lines = printed(rs.summary(branch), width)
    hopf = [line for line in lines if line.startswith("hopf")]
    assert hopf[0].split()[1:3] == [f"{1e3 * SLIDER.V_c:.6g}", "mm/s"]
    assert len(hopf) == tables
    assert max(map(len, lines[1:])) <= width


def test_columns_that_may_go_are_left_out_before_a_table_is_split():
    spare = Heading("68 %", may_go=True, joined=True)
    columns = [left(), Heading("one"), spare, Heading("two"), spare]
    columns += [Heading("95 %", joined=True), left("", may_go=True)]
    table = TextTable(columns, [["K", "11", "2", "33", "4", "55", "stiffness"]], splits=True)
    wide = 1 + 3 + 4 + 3 + 4 + 4 + 9 + 6 * 3
    assert table.parts(wide) == [[0, 1, 2, 3, 4, 5, 6]]
    assert table.parts(wide - 1) == [[0, 1, 3, 5, 6]]
    assert table.parts(wide - 15) == [[0, 1, 3, 5]]
    assert table.parts(16) == [[0, 1], [0, 3, 5]]
    assert table.markdown().splitlines() == [
        "|  | one | 68 % | two | 68 % | 95 % |  |",
        "| --- | ---: | ---: | ---: | ---: | ---: | --- |",
        "| K | 11 | 2 | 33 | 4 | 55 | stiffness |",
    ]


def test_a_quantity_without_values_has_no_row():
    """A quantity that is NaN in all cases has no row."""
    slider = SLIDER.replace(M=0.0, K=xr.DataArray([5e8, 5.5e8], dims="K"))
    found = rs.sweep("limit_cycle", slider, V_lp=1e-3, progress=False)
    assert np.isnan(found.amplitude).all()
    assert not any(line.startswith("amplitude") for line in printed(rs.summary(found), 80))


OUTSIDE = "leave the domain of the friction law, which describes forward slip only: "


def test_cases_outside_the_domain_are_counted_and_listed():
    V_lp, K = rs.logspace("V_lp", 1.0, 100.0, 5), rs.logspace("K", 4e7, 4e8, 2)
    found = rs.sweep("limit_cycle", SLIDER.replace(K=K), V_lp=V_lp, progress=False)
    code = found.outside_domain.transpose("K", "V_lp").values
    assert 0 < (code > 0).sum() < code.size
    lines = printed(rs.summary(found), 300)
    (at,) = (i for i, line in enumerate(lines) if OUTSIDE in line)
    mu, spring = (int((code & bit > 0).sum()) for bit in (1, 2))
    assert lines[at].rstrip() == (
        f"{(code > 0).sum()} of 10 cases {OUTSIDE}mu falls below 0 in {mu}, "
        f"the spring pulls back harder than friction can hold in {spring}"
    )
    assert lines[at + 1].strip() == ""  # there are too many to list
    one = found.isel(K=[0])
    lines = printed(rs.summary(one), 300)
    (at,) = (i for i, line in enumerate(lines) if OUTSIDE in line)
    places = [f"K = 40 MPa/m, V_lp = {V:.6g} m/s" for V in one.V_lp.values[code[0] > 0]]
    assert [line.strip() for line in lines[at + 1 : at + 1 + len(places)]] == places
    inside = found.where(found.V_lp < 2.0, drop=True).assign(
        {name: found[name].isel(V_lp=[0]) for name in ("status", "outside_domain", "message")}
    )
    assert not any(OUTSIDE in line for line in printed(rs.summary(inside), 300))


@pytest.mark.parametrize("hopf", [False, True])
def test_cycles_of_a_branch_are_counted_and_those_outside_the_domain(hopf):
    ends = (5e-3, 3e-3) if hopf else (5.0, 10.0)
    slider = SLIDER if hopf else SLIDER.replace(K=4e7)
    branch = rs.continue_cycle(slider, "V_lp", *ends, rtol=1e-6)
    title, *lines = printed(rs.summary(branch), 300)
    cycles = branch.sizes["point"] - hopf
    assert title.startswith(f"A branch of {cycles} limit cycles, V_lp from ")
    assert "all of them stable" in title
    outside = branch.outside_domain.values > 0
    assert outside.any() != hopf
    if not hopf:
        assert lines[0].startswith(f"{outside.sum()} of {cycles} cycles {OUTSIDE}")
        first = float(branch.V_lp[outside.argmax()])
        assert lines[1].strip() == f"V_lp = {first:.6g} m/s to 10 m/s"


def test_a_report_is_text_a_page_and_rich(cycle):
    report = rs.summary(cycle)
    text = str(report)
    assert text.startswith("The limit cycle at V_lp = 10 mm/s, slip law\n")
    assert f"{1e3 * float(cycle.period):.6g} ms" in text
    assert not any(line.endswith(" ") for line in text.splitlines())
    assert "<pre>" in report._repr_html_()
    in_seconds = str(rs.summary(cycle, {"period": "s"}))
    assert f"{float(cycle.period):.6g} s" in in_seconds


@pytest.mark.parametrize("other", [3, xr.Dataset(), xr.Dataset(attrs={"title": "ratestate hopf"})])
def test_only_results_have_a_report(other):
    with pytest.raises(rs.ParameterError, match=r"result|title"):
        rs.summary(other)


def test_arrays_of_any_function_and_other_results_have_a_report():
    K = xr.DataArray([5e8, 9e8], dims="K")
    lines = str(rs.summary(rs.stability(SLIDER.replace(K=K), 1e-2))).splitlines()
    assert lines[0] == "2 cases of stability over K (2 from 500 MPa/m to 900 MPa/m)"
    assert any(line.startswith("growth_rate") and "K = 900 MPa/m" in line for line in lines)
    found = rs.stabilize(SLIDER, 1e-2)
    text = str(rs.summary(found))
    assert text.startswith("Result of stabilize\n")
    assert f"{float(found.M_stable):.6g} kg/m^2" in text


def test_an_unstable_slider_s_report_says_what_makes_it_stable():
    brake = rs.SpringSlider(
        a=0.003, b=0.006, Dc=1e-5, sigma="4 kN", K="2 MN/m", M="6 kg", area="20 cm^2"
    )
    lines = str(rs.summary(rs.stability(brake, 0.01))).splitlines()
    remedies = lines[lines.index("Each alone makes it stable at 1.1 V_lp = 11 mm/s") :]
    found = rs.stabilize(brake, 0.01)
    for row, name in zip(remedies[3:], ("K", "M", "damping"), strict=True):
        assert row.split()[0] == name
        scale = {"K": 1e-6, "M": 1.0, "damping": 1.0}[name] * 2e-3  # MN/m, kg, N s/m
        assert f" {float(found[f'{name}_stable']) * scale:.4g} " in row
    assert "Each alone" not in str(rs.summary(rs.stability(brake.replace(b=0.002), 0.01)))


@pytest.mark.parametrize(
    ("found", "units"),
    [
        (lambda: rs.limit_cycle(SLIDER, 1e-2), {"V_max": "mm/s", "period": "ms"}),
        (lambda: rs.stability(SLIDER, 1e-2), {"K_c": "MPa/m", "V_lp": "mm/s"}),
        (lambda: rs.stability(SLIDER, rs.logspace("V_lp", 1e-3, 1e-1, 3)), {"V_lp": "um/s"}),
        (lambda: rs.continue_cycle(SLIDER, "K", 9e8, 8.95e8, V_lp=1e-2), {"K": "MPa/m"}),
    ],
)
def test_units_of_the_variables_are_read(found, units):
    """The report on a result does not depend on the units of its variables."""
    result = found()
    assert str(rs.summary(rs.in_units(result, **units))) == str(rs.summary(result))


def test_single_values_of_other_functions_are_listed_with_their_texts(cycle):
    text = str(rs.summary(rs.classify(cycle)))
    assert re.search(r"^regime +quasi-harmonic ", text, re.MULTILINE)
    assert re.search(r"^eta +5 ", text, re.MULTILINE)
