"""Forces, displacements and accelerations of a contact whose area is known."""

import re

import numpy as np
import pytest

import ratestate as rs
from ratestate.dynamics.results import whole_contact

SLIDER = rs.SpringSlider.of_contact(
    area="20 cm^2",
    mass="6 kg",
    stiffness="1.8 MN/m",
    normal_force="4 kN",
    a=0.003,
    b=0.006,
    Dc="10 um",
)


@pytest.fixture(scope="module")
def cycle():
    return rs.limit_cycle(SLIDER, "3.2 mm/s")


def test_forces_and_accelerations_of_a_run():
    times = np.linspace(0.0, 0.2, 4001)
    loading = rs.Loading.constant("3.2 mm/s")
    run = rs.simulate(SLIDER, loading, 0.2, V_start="3 mm/s", times=times)
    contact = whole_contact(run)
    np.testing.assert_allclose(contact.force, 2e-3 * run.tau, rtol=1e-15)
    assert contact.force.units == "N"
    # Newton: the acceleration is the derivative of the velocity
    a, t = contact.acceleration.values, run.time.values
    change = np.sum(0.5 * (a[1:] + a[:-1]) * np.diff(t))
    assert change == pytest.approx(float(run.V[-1] - run.V[0]), rel=1e-2)
    assert np.abs(a).max() == pytest.approx(float(contact.acceleration_max), rel=1e-3)


def test_forces_and_accelerations_of_a_cycle(cycle):
    contact = whole_contact(cycle)
    force = float(cycle.amplitude) * 4000.0
    assert float(contact.force_amplitude) == pytest.approx(force, rel=1e-14)
    assert float(contact.displacement_amplitude) == pytest.approx(force / 1.8e6, rel=1e-14)
    omega = 2 * np.pi * float(cycle.frequency)  # a nearly harmonic cycle
    speed = 0.5 * float(cycle.V_max - cycle.V_min)
    assert float(contact.acceleration_max) == pytest.approx(omega * speed, rel=0.15)


def test_nothing_without_area_and_no_acceleration_without_mass(cycle):
    assert not whole_contact(rs.limit_cycle(SLIDER.replace(area=None), "3.2 mm/s"))
    steady = whole_contact(
        rs.simulate(SLIDER.replace(M=0.0, b=0.002), rs.Loading.constant(1e-3), 1)
    )
    assert steady.acceleration.isnull().all()
    assert steady.force.notnull().all()


def test_the_verdict_states_the_force(cycle):
    answer = rs.verdict(SLIDER, "3.2 mm/s")
    assert answer.force_amplitude == pytest.approx(4000 * float(cycle.amplitude), rel=1e-6)
    assert ", force 4.939 N, V between" in answer.sentences[0]
    without = rs.verdict(SLIDER.replace(area=None), "3.2 mm/s")
    assert without.force_amplitude is None
    assert "force" not in without.sentences[0]


def test_answers_are_in_the_units_of_the_whole_contact():
    found = rs.stability(SLIDER, "3.2 mm/s")
    report = str(rs.summary(found))
    assert re.search(r"^K +1.8 MN/m +stiffness of the whole spring", report, re.MULTILINE)
    assert re.search(r"^K +>= [\d.]+ MN/m", report, re.MULTILINE)  # what would make it stable
    assert "Pa" not in report
    assert re.search(r"^K_c +[\d.]+ MPa/m", str(rs.summary(found, {"K_c": "MPa/m"})), re.MULTILINE)
    verdict = rs.verdict(SLIDER, "3.2 mm/s")
    assert verdict.text.count("MN/m") == 3  # K, K_c and K_c_qs
    page = rs.plot.figure(found)
    assert page.axes[0].get_ylabel() == "$K$ [MN/m]"
    assert r"$F_n$ = 4 kN, $M$ = 6 kg, $K$ = 1.8 MN/m" in page.get_suptitle()


def test_axes_of_a_sweep_are_in_the_units_of_the_whole_contact():
    """The places of the cases and of the line K = K_c keep their proportions."""
    slider = SLIDER.replace(sigma=rs.logspace("sigma", "1 MPa", "4 MPa", 7))
    found = rs.stability(slider, rs.logspace("V_lp", "1 mm/s", "10 mm/s", 7))
    assert "over sigma (7 from 2 kN to 8 kN)" in str(rs.summary(found))
    page = rs.plot.figure(found)
    assert page.axes[0].get_ylabel() == r"Normal force $F_n$ [kN]"
    low, high = page.axes[0].get_ylim()
    assert low * high == pytest.approx(16.0, rel=1e-6)  # they are 1.9 and 8.5 kN
    assert "[MN/m]" in " ".join(ax.get_xlabel() for ax in page.axes)
    few = rs.plot.figure(rs.stability(SLIDER.replace(K=rs.logspace("K", 9e8, 4e9, 3)), "3 mm/s"))
    assert few.axes[-1].get_xlabel() == "Stiffness of the whole spring $K$ [MN/m]"


def test_a_unit_may_be_of_the_whole_contact_or_per_area():
    found = rs.stability(SLIDER, "3.2 mm/s")
    report = str(rs.summary(found, {"K": "kN/mm", "K_c": "GPa/m"}))
    assert re.search(r"^K +1.8 kN/mm +stiffness of the whole spring", report, re.MULTILINE)
    per_area = rf"^K_c +{float(found.K_c) / 1e9:.6g} GPa/m +critical stiffness"
    assert re.search(per_area, report, re.MULTILINE)
    with pytest.raises(rs.ParameterError, match="K = 'kN' is a force"):
        rs.summary(found, {"K": "kN"})


def test_dimensions_of_the_whole_contact_have_the_symbols_of_parameters():
    values = {"mass": "6 kg", "stiffness": "1.8 MN/m", "area": "20 cm^2"}
    forces = np.array([3e3, 4e3, 5e3])
    slider = rs.SpringSlider.of_contact(a=0.003, b=0.006, Dc="10 um", normal_force=forces, **values)
    fig = rs.plot.figure(rs.stability(slider, "3.2 mm/s"))
    assert "$F_n$" in " ".join(ax.get_xlabel() for ax in fig.axes)
