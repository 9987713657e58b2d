"""Tables of results in terminals of any width."""

import numpy as np
import pytest
import xarray as xr
from rich.console import Console
from rich.table import Table

import ratestate as rs
from ratestate.interfaces.cli.report import report
from ratestate.interfaces.cli.report.rows import FirstThatFits

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
    lines = printed(report(sweep, None), width)
    table = lines[next(i for i, line in enumerate(lines) if "─" in line) + 1 :]
    beside = width == 140
    assert len(table) == (7 if beside else 14)
    for line in table:
        assert line.count(" = ") == (4 if beside else 2), line
        assert len(line) <= width
    most = sweep.amplitude.where(sweep.amplitude == sweep.amplitude.max(), drop=True)
    row = table[0 if beside else 1].rstrip()
    assert f"{float(most.max()):.6g}" in row
    assert row.endswith(f"V_lp = {1e3 * float(most.V_lp[0]):.6g} mm/s")


@pytest.mark.parametrize("width", [80, 100])
def test_text_beside_errors_has_room(cycle, width):
    lines = printed(report(cycle, None), width)
    head, value = (next(line for line in lines if name in line) for name in ("relative", "value"))
    assert head.split() + value.split() == ["relative", "value", "error"]
    period = next(line for line in lines if line.startswith("period"))
    assert width - period.index("period of the limit cycle") >= 30 + width - 80
    assert max(map(len, lines)) <= width


@pytest.mark.parametrize(("width", "digits"), [(80, 4), (100, 6)])
def test_points_of_a_branch_are_on_a_line_each(width, digits):
    branch = rs.continue_cycle(SLIDER, "V_lp", 5e-3, 3e-3, rtol=1e-6)
    lines = printed(report(branch, None), width)
    hopf = next(line for line in lines if line.startswith("hopf"))
    assert hopf.split()[1:3] == [f"{1e3 * SLIDER.V_c:.{digits}g}", "mm/s"]
    assert len(lines) - lines.index(hopf) == 1


@pytest.mark.parametrize(("width", "expected"), [(9, "wide"), (8, "bb"), (2, "bb")])
def test_the_first_layout_that_fits(width, expected):
    tables = []
    for cell in ("wide cell", "bb"):
        table = Table(box=None, show_header=False, padding=0)
        table.add_row(cell)
        tables.append([table])
    assert printed([FirstThatFits(*tables)], width)[0].startswith(expected)


def test_of_nothing_there_is_no_range():
    """A quantity that is NaN in all cases has no row."""
    slider = SLIDER.replace(M=0.0, K=xr.DataArray([5e8, 5.5e8], dims="K"))
    found = rs.sweep("limit_cycle", slider, V_lp=1e-3, progress=False)
    assert np.isnan(found.amplitude).all()
    assert not any(line.startswith("amplitude") for line in printed(report(found, None), 80))
