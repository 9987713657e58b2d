"""Forces, displacements and accelerations of a contact whose area is known."""

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


def test_of_a_run():
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


def test_of_a_cycle(cycle):
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
