"""Real laboratory records (Giacomel et al. 2024, Geosphere), if they are available."""

import pytest
from paths import LAB

import ratestate as rs

FREE = ["a", "b", "Dc", "K"]


def read(name):
    path = LAB / name
    if not path.exists():
        pytest.skip(f"{name} is not here")
    return rs.read_lab(path)


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_basalt_from_3_to_10_um_s():
    """Compare with an independent quasi-static fit, with errors of a few per cent."""
    record = read("velstep4_BRAVA_expb819_basalt.txt")
    assert "3 -> 10 um/s" in record.attrs["found"]
    slider = rs.SpringSlider(a=0.01, b=0.01, Dc="10 um", sigma="20 MPa", K="40 GPa/m")
    both = rs.fit(record, slider, law=("slip", "aging"))
    assert "the estimates depend on the trend" in both.warnings.sel(law="slip").item()
    expected = {"slip": (0.0092, 0.0094, 8.7e-6), "aging": (0.0089, 0.0091, 6.5e-6)}
    for law, values in expected.items():
        result = both.sel(law=law)
        for name, value, within in zip(FREE, values, (0.05, 0.05, 0.15), strict=False):
            assert float(result[name]) == pytest.approx(value, rel=within), (law, name)
        assert float(result.noise_time) == pytest.approx(0.03, rel=0.3)
        assert 3.0 < float(result.chi2_white) < 4.5
        assert -0.0009 < float(result.a_minus_b) < 0.0
    # without the trend Dc is what a fit with trend=None gives, 7.41 um
    assert float(both.without_trend.sel(law="slip", parameter="Dc")) == pytest.approx(
        7.41e-6, rel=0.03
    )


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_sepiolite_from_0_2_to_2_um_s():
    """Strengthening is much larger than a, so that b is negative."""
    record = read("velstep3_TR2_exp013_sepiolite.txt")
    assert "0.2 -> 2 um/s" in record.attrs["found"]
    slider = rs.SpringSlider(a=0.01, b=0.01, Dc="10 um", sigma="30 MPa", K="40 GPa/m")
    result = rs.fit(record, slider, errors="covariance")
    assert 0.008 < float(result.a) < 0.013
    assert -0.014 < float(result.b) < -0.008
    assert float(result.a_minus_b) == pytest.approx(0.021, abs=0.003)
    # undulations over tens of seconds count as noise, and enlarge the errors
    assert float(result.noise_time) > 20.0
    assert float(result.standard_error.sel(parameter="a_minus_b")) > 2e-4


@pytest.mark.filterwarnings("ignore::ratestate.errors.FitWarning")
def test_sepiolite_has_two_distances():
    """AIC prefers a second state with ten times the distance; both strengthen."""
    record = read("velstep3_TR2_exp013_sepiolite.txt")
    own = {"law": "two-state-slip", "b2": 0.002, "Dc2": "100 um"}
    slider = rs.SpringSlider(a=0.01, b=0.01, Dc="10 um", sigma="30 MPa", K="40 GPa/m", **own)
    free = (*FREE, "b2", "Dc2")
    both = rs.fit(record, slider, free, law=("slip", "two-state-slip"), errors="covariance")
    assert 8.0 < float(both.aic_difference.sel(law="slip")) < 35.0
    two = both.sel(law="two-state-slip")
    assert -0.010 < float(two.b) < -0.004
    assert -0.011 < float(two.b2) < -0.005
    assert 12e-6 < float(two.Dc) < 40e-6
    assert 15e-5 < float(two.Dc2) < 65e-5
    assert float(two.a_minus_b) == pytest.approx(0.024, abs=0.003)
