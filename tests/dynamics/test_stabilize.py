"""`stabilize`: each remedy alone makes steady sliding just stable."""

import numpy as np
import pytest

import ratestate as rs

SLIDER = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="1 GPa/m", M=3000)
CHANGED = ("K", "M", "damping")


def edges(slider, V_lp, margin):
    found = rs.stabilize(slider, V_lp, margin)
    return {name: float(found[f"{name}_stable"]) for name in CHANGED}


def is_stable(slider, V, **changes):
    return bool(rs.stability(slider.replace(**changes), V).stable)


@pytest.mark.parametrize(
    "slider",
    [
        SLIDER,
        SLIDER.replace(damping="20 kPa s/m"),
        SLIDER.replace(friction_form="cut-off", V1="100 m/s", V2="1 m/s"),
        rs.SpringSlider(
            **{s: getattr(SLIDER, s) for s in ("a", "b", "Dc", "sigma", "M")},
            K="3 GPa/m",
            law="two-state-aging",
            b2=0.002,
            Dc2="3 um",
        ),
        SLIDER.replace(law="nagata", c=1.0, K="1.2 GPa/m"),
    ],
    ids=["slip", "damped", "cut-off", "two states", "nagata"],
)
def test_stability_changes_at_the_edge(slider):
    V = 1.2 * 0.02
    assert not is_stable(slider, V)
    for name, edge in edges(slider, "20 mm/s", 1.2).items():
        toward = -1e-6 if name == "M" else 1e-6
        assert is_stable(slider, V, **{name: edge * (1.0 + toward)}), name
        assert not is_stable(slider, V, **{name: edge * (1.0 - toward)}), name


def test_mass_and_stiffness_agree_with_eqs_6_and_7():
    found, V = rs.stabilize(SLIDER, 0.01, margin=1.0), 0.01
    K_c_qs = (SLIDER.b - SLIDER.a) * SLIDER.sigma / SLIDER.Dc
    M = SLIDER.a * SLIDER.sigma * SLIDER.Dc / V**2 * (SLIDER.K / K_c_qs - 1.0)
    np.testing.assert_allclose(found.M_stable, M, rtol=1e-12)
    np.testing.assert_allclose(found.K_stable, rs.stability(SLIDER, V).K_c, rtol=1e-12)
    np.testing.assert_allclose([found.V_c_with_K, found.V_c_with_M], V, rtol=1e-7)
    ratio = found.damping_stable / (2.0 * np.sqrt(SLIDER.K * SLIDER.M))
    np.testing.assert_allclose(found.damping_ratio_stable, ratio, rtol=1e-12)


def test_a_soft_spring_needs_more_than_less_mass():
    found = rs.stabilize(SLIDER.replace(K="500 MPa/m"), 0.01)
    assert np.isnan([found.M_stable, found.V_c_with_M]).all()
    assert found.V_c_with_damping == 0.0  # slow sliding stays unstable
    without_mass = rs.stabilize(SLIDER.replace(K="500 MPa/m", M=0.0), 0.01)
    assert np.isnan(without_mass.damping_ratio_stable)
    assert 0.0 < without_mass.damping_stable < found.damping_stable
    assert (without_mass.V_c_with_K, without_mass.V_c_with_damping) == (np.inf, 0.0)


def test_a_stable_slider_needs_nothing():
    found = rs.stabilize(SLIDER.replace(b=0.002), 0.01)
    assert (found.K_stable, found.damping_stable) == (0.0, 0.0)
    assert np.isinf([found.M_stable, found.V_c_with_K]).all()


@pytest.mark.parametrize("margin", [0.0, -1.0, "1 m", np.nan])
def test_impossible_margins_are_refused(margin):
    with pytest.raises(rs.ParameterError, match="margin"):
        rs.stabilize(SLIDER, 0.01, margin)
