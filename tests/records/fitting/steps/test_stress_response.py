"""alpha from a step of normal stress that gives only an upper bound."""

import numpy as np
import pytest
from synthetic_records import correlated

import ratestate as rs
from ratestate.model.quantities import short
from ratestate.records.fitting.steps.windows import windows_of
from ratestate.report.steps import table_of

pytestmark = pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
SLIDER = rs.SpringSlider(a=0.009, b=0.012, Dc="20 um", sigma="8 MPa", K="6 GPa/m", alpha=0.0)
START = SLIDER.replace(alpha=0.1)
SLOW, FAST = 3e-6, 1e-5


@pytest.fixture(scope="module")
def data():
    loading = rs.Loading.steps(SLOW, (150.0, FAST), (220.0, SLOW)).sigma_step(400.0, "8.8 MPa")
    t = np.arange(600.0)
    run = rs.simulate(SLIDER, loading, t[-1], times=t, rtol=1e-9)
    rng = np.random.default_rng(10)
    noise = 3e-4 * correlated(t, 5.0, rng) + 1e-4 * rng.normal(size=t.size)
    return run[["delta_lp", "sigma"]].assign(friction=run.tau / run.sigma + noise)


@pytest.fixture(scope="module")
def result(data):
    return rs.fit(data, START, per_step=True)


def test_the_interval_of_an_estimate_at_its_bound_is_closed_above(data):
    """Widening by the noise's uncertainty would move the upper end to the bound."""
    alone = rs.fit(windows_of(data)[-1].part(data), START, free=("alpha",))
    assert float(alone.alpha) < 1e-6
    (low, high), (lower, upper) = alone.interval.sel(parameter="alpha").values
    assert low == lower == 0.0
    error = float(alone.standard_error.sel(parameter="alpha"))
    assert 0.1 * error < high < error
    assert 1.5 * high < upper < 3.0 * error
    assert f"alpha < {short(upper)} (95 %)" in str(alone.warnings.item())


def test_the_table_shows_the_upper_bound_of_alpha(result):
    """The interval is widened by the errors of a, b, Dc and K."""
    columns, rows, _ = table_of(result, "slip")
    of_stress = next(row for row in rows if row[0] == "3")
    upper = float(result.interval.sel(parameter="alpha", level=0.95, side="upper")[-1])
    assert 0.005 < upper < 0.05
    assert (
        of_stress[[one.head for one in columns].index("alpha [1e-3]")] == f"< {short(1e3 * upper)}"
    )
    assert f"alpha < {short(upper)} (95 %)" in str(result.warnings[-1].item())
    assert of_stress[:3] == ["3", "399.5", "sigma 8 -> 8.8 MPa"]
    report = str(rs.summary(result))
    assert "sigma 8 -> 8.8 MPa" in report
    assert "The sign < stands" in report
    assert "The sign > stands" not in report  # the table has no such cell


def test_normal_stress_before_and_after(result):
    np.testing.assert_allclose(result.sigma, 8e6, rtol=1e-6)
    np.testing.assert_allclose(result.sigma_after, [np.nan, np.nan, 8.8e6], rtol=1e-6)
