"""A fit as text: `summary`; the estimated slider: `rs.fitted_slider`."""

import re

import numpy as np
import pytest
from synthetic_records import SLIDER, STEP, record

import ratestate as rs
from ratestate import ParameterError
from ratestate.model.quantities import with_error
from ratestate.records import fitting
from ratestate.records.fitting.by_law import error_of, results_by_law, stiffness_over_critical
from ratestate.report.fits import estimates, noise_text
from ratestate.report.report import numbers_by_text

pytestmark = pytest.mark.filterwarnings("ignore::ratestate.FitWarning")


@pytest.fixture(scope="module")
def both():
    """Return a fit of a step under both laws."""
    data = record(SLIDER, STEP, np.linspace(0.0, 130.0, 521), noise=3e-4)
    start = SLIDER.replace(M=4800)
    return rs.fit(data, start, law=("slip", "aging"), errors="covariance")


def refuted(result, low, high, level=0.68):
    """Return a result with other ends [SI] of an interval of K, from a profile."""
    kind, interval = result.interval_kind.astype(object).copy(), result.interval.copy()
    kind.loc[{"parameter": "K"}] = "profile"
    interval.loc[{"parameter": "K", "level": level}] = np.array([low, high])
    return result.assign(interval_kind=kind.astype(str), interval=interval)


def test_the_summary_has_a_row_for_each_quantity(both):
    text = str(rs.summary(both))
    rows = [re.split(r"  +", line) for line in text.partition("\n\n")[0].splitlines() if line]
    by_label = {row[0]: row[1:] for row in rows}
    assert rows[0][0] == "Fit of 521 samples, slip and aging laws"
    assert by_label[""] == ["slip law", "95 % interval", "aging law", "95 % interval"]
    for i, law in enumerate(("slip", "aging")):
        one = both.sel(law=law)
        error = 1e6 * float(one.standard_error.sel(parameter="Dc"))
        low, high = 1e6 * one.interval.sel(parameter="Dc", level=0.95).values
        value, interval = by_label["Dc [um]"][2 * i : 2 * i + 2]
        assert value == with_error(1e6 * float(one.Dc), error)
        assert [float(end) for end in interval.split(" to ")] == pytest.approx(
            [low, high], abs=0.5 * error
        )
    for part in (both.attrs["comparison"], *both.identifiability.values, "M = 4800 kg/m^2"):
        assert part in " ".join(text.split())
    warnings = str(both.warnings[1].item()).splitlines()
    assert text.count("aging law, which fits clearly worse: ") == len(warnings)
    assert "warning:" not in text
    warned = str(rs.summary(both.assign(warnings=("law", ["first", "second"]))))
    assert "warning: slip law: first" in warned
    assert "warning: aging" not in warned
    assert max(map(len, text.splitlines())) < 120
    assert not re.search(r"\d\n +(%|um|s)\b", text)


def test_an_interval_from_a_profile_gives_the_standard_error(both):
    (part,) = results_by_law(refuted(both.sel(law="slip"), 5.0e10, 9.0e10)).values()
    assert error_of(part, "K") == 2.0e10
    (K,) = (row for row in estimates({"slip": part}) if row.symbol == "K")
    assert K.texts[0][0] == with_error(1e-9 * float(part.K), 20.0)
    assert K.texts[0][1] == "50 to 90"
    wide, usual = (stiffness_over_critical(one)[1] for one in (part, results_by_law(both)["slip"]))
    assert wide > 2.0 * usual


def test_stiffness_over_critical_depends_on_a_minus_b_only(both):
    """Its error is finite even if the errors of a and b are not."""
    (part,) = results_by_law(both.sel(law="slip")).values()
    kind, interval = part.interval_kind.astype(object).copy(), part.interval.copy()
    for symbol in ("a", "b"):
        kind.loc[{"parameter": symbol}] = "profile"
        interval.loc[{"parameter": symbol}] = np.array([0.0, np.inf])
    vague = part.assign(interval_kind=kind.astype(str), interval=interval)
    assert error_of(vague, "a") == error_of(vague, "b") == np.inf
    assert stiffness_over_critical(vague) == stiffness_over_critical(part)
    assert stiffness_over_critical(part)[1] < np.inf


@pytest.mark.parametrize(
    ("ends", "shown"), [((5e10, np.inf), "50 to (open)"), ((0, 9e10), "0 to 90")]
)
def test_an_open_interval_has_no_error(both, ends, shown):
    (part,) = results_by_law(refuted(both.sel(law="slip"), *ends)).values()
    (other,) = results_by_law(refuted(both.sel(law="slip"), *ends, level=0.95)).values()
    assert error_of(other, "K") == np.inf
    cells = {row.symbol: row.texts[0] for row in estimates({"slip": part})}
    assert error_of(part, "K") == np.inf
    assert "+-" not in cells["K"][0]
    assert cells["K"][1] == shown
    assert "+-" not in cells["K/K_c_qs"][0]
    assert "+-" in cells["a"][0]


def test_a_greater_than_b_is_stable_at_any_K(both):
    part = results_by_law(both.assign(a=both.b + 0.001))["slip"]
    (ratio,) = (row for row in estimates({"slip": part}) if row.symbol == "K/K_c_qs")
    assert ratio.texts[0][0] == "stable at any K"


@pytest.mark.parametrize(
    ("white", "red", "exponent", "expected"),
    [
        (3e-4, 0.0, 0.0, "0.0003, white"),
        (7e-7, 7.93e-4, 0.0, "0.00079, correlated over 28.2 ms"),
        (2e-4, 3e-4, 0.0, "0.0002, white, and 0.0003, correlated over 28.2 ms"),
        (2e-4, 3e-4, 1.24, "0.0002, white, and 0.0003, with a spectrum of 1/f^1.2"),
    ],
)
def test_noise_as_text(white, red, exponent, expected):
    values = {"noise_white": white, "noise_red": red, "noise_time": 0.0282}
    assert noise_text(values | {"noise_exponent": exponent}) == expected
    assert exponent or noise_text(values) == expected  # results of older versions lack the exponent


def test_a_warning_of_several_steps_is_written_once():
    texts = [*enumerate((["one", "two"], [], ["two"], ["two", "three"]), 1)]
    expected = [("step 1", "one"), ("steps 1, 3, 4", "two"), ("step 4", "three")]
    assert [*numbers_by_text("step", texts)] == expected
    assert [*numbers_by_text("step", texts, 2)][1] == ("steps 1, 3 and 1 more", "two")


def test_the_estimated_slider(both):
    slider = rs.fitted_slider(both, "aging")
    one = both.sel(law="aging")
    found = {symbol: float(one[symbol]) for symbol in ("a", "b", "Dc", "K", "mu0")}
    assert slider == SLIDER.replace(M=4800, law="aging", **found)
    assert slider == rs.fitted_slider(one)
    # fitted friction equals that of a run of this slider
    run = rs.simulate(slider, STEP, 130.0, times=both.time.values)
    trend = float(one.trend_slip) * (run.delta - run.delta[0]).values
    friction = (run.tau / slider.sigma).values + trend
    np.testing.assert_allclose(friction, one.friction_fit, atol=2e-6)


def test_datasets_without_a_slider_or_summary_are_refused(both):
    with pytest.raises(ParameterError, match=r"several laws\. Give law='slip' or law='aging'"):
        rs.fitted_slider(both)
    with pytest.raises(ParameterError, match="law = 'nope' is unknown"):
        rs.fitted_slider(both, "nope")
    for function in (rs.fitted_slider, rs.summary):
        with pytest.raises(ParameterError, match=r"the Dataset that fit returns|title"):
            function(both.drop_attrs())
        with pytest.raises(ParameterError, match=r"complete|lost"):
            function(both[["Dc"]])
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = fitting.nonsense
