"""Errors of cycles where amplitudes change up to millions of times faster than the stiffness."""

import numpy as np
import pytest

import ratestate as rs

# Law; a, b, Dc, sigma, K, M, V_lp [SI]; period [s] and amplitude to 12 digits and more.  Found by a
# program of its own: shooting with the Radau IIA collocation of 9 stages (order 17) in 80-bit
# floating point, from exactly these parameters; two tolerances of it agree to 2e-13.
CANARD = (0.01, 0.2388660833, 1e-5, 1e7, 228866011400.0, 11757.21134, 1e-5)
CYCLES = {
    # d ln(amplitude)/d ln K is 2e5, 3e5, 7e7 and 3e7
    "b/a = 12": (
        ("slip", 0.001, 0.012, 1e-5, 1e7, 10991853137.3, 100.0, 1e-3),
        (0.040022558672015714, 0.01735287719016315),
    ),
    "b/a = 24": (
        ("slip", 0.001, 0.024, 1e-5, 1e7, 22993116422.3, 100.0, 1e-3),
        (0.025957942391838996, 0.016511179204282286),
    ),
    "hardly attracts": (("slip", *CANARD), (2.009717741933918, 0.09432041277163293)),
    "and less": (
        ("slip", *CANARD[:4], 228866026272.0, *CANARD[5:]),
        (1.8646757672605652, 0.07864167702025197),
    ),
    "no inertia to speak of": (
        (
            *("slip", 0.008851048452, 0.02381876227, 1.980448789e-06, 50475071.25),
            *(381458406800.0, 156566.589, 4.004428241e-07),
        ),
        (84.58934596408804, 0.19610588575416374),
    ),
    "beside K_c": (
        (
            *("slip", 0.001738894982, 0.002581570073, 6.078311484e-05, 32879589.81),
            *(455758904.8, 7284.038741, 2.578971085e-06),
        ),
        (389.7828501213276, 0.010045262418423082),
    ),
    "small, b/a near 1": (
        (
            *("slip", 0.003004526271, 0.003050092703, 2.600654225e-05, 31843082.14),
            *(245665843.3, 13405358820.0, 2.513343564e-05),
        ),
        (52.794130217013205, 1.766259838185483e-05),
    ),
    "stick-slip": (
        ("aging", 0.005, 0.008, 1e-5, 4e6, 0.96e9, 100.0, 1e-5),
        (32.67659151248119, 0.07356797894860911),
    ),
    "beyond K_c": (
        ("aging", 0.001, 0.012, 1e-5, 1e7, 11056027392.4, 100.0, 1e-3),
        (0.03784635423441669, 0.035484097914337785),
    ),
}


def slider_of(law, a, b, Dc, sigma, K, M, V_lp):
    return rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, law=law), V_lp


def true_error(cycle, period, amplitude):
    return max(abs(cycle.period / period - 1), abs(cycle.amplitude / amplitude - 1))


@pytest.mark.parametrize("name", CYCLES)
@pytest.mark.parametrize("rtol", [1e-6, 1e-10])
def test_error_bounds_the_true_error_and_not_by_far(name, rtol):
    slider, exact = CYCLES[name]
    slider, V_lp = slider_of(*slider)
    cycle = rs.limit_cycle(slider, V_lp, rtol=rtol)
    assert true_error(cycle, *exact) <= cycle.error
    # what double precision can do: on the steepest of these a digit of K is 2e-16 * 7e7
    assert cycle.error < max(rtol, 1e-6 if name in ("hardly attracts", "and less") else 2e-8)


@pytest.mark.parametrize("rtol", [1e-8, 1e-11, 1e-12])
def test_tolerances_of_steps_stay_above_rounding(rtol):
    """tau/(a sigma) swings by 441: the steps' tolerance, 2e-14, is less than its last digit."""
    slider, V_lp = slider_of("slip", *CANARD[:4], 2.2e11, *CANARD[5:])
    cycle = rs.limit_cycle(slider, V_lp, rtol=rtol)
    assert true_error(cycle, 22.959474288247225, 4.41447382479116) <= cycle.error < max(rtol, 1e-11)


@pytest.fixture(scope="module")
def branch():
    """From the Hopf point down the steepest canard, to a stiffness with a known cycle."""
    slider, V_lp = slider_of("slip", *CANARD)
    return rs.continue_cycle(slider, "K", 1.00001 * 228866352382.7, CANARD[4], V_lp=V_lp)


def test_the_branch_ends_at_the_very_parameter(branch):
    end = branch.isel(point=-1)
    assert (end.special, end.K) == ("stop", CANARD[4])
    assert true_error(end, *CYCLES["hardly attracts"][1]) <= end.error < 1e-6


def test_each_point_of_a_steep_branch_has_the_cycle_of_its_parameter(branch):
    """Each point, against the cycle that is found anew at its stiffness, where that is certain.

    K changes by 1.5e-6 of itself over all of these points, and the amplitude 48-fold.
    """
    looked_at = 0
    for i in range(3, branch.sizes["point"], 5):
        point = branch.isel(point=i)
        slider, V_lp = slider_of("slip", *CANARD[:4], float(point.K), *CANARD[5:])
        cycle = rs.limit_cycle(slider, V_lp, rtol=1e-10)
        if cycle.error > 1e-5:
            continue
        looked_at += 1
        assert true_error(point, cycle.period, cycle.amplitude) <= point.error + cycle.error
        assert point.error < 2e-6
    assert looked_at >= 3


def test_the_error_is_at_least_slope_times_rounding(branch):
    """Half of K's last digit moves the amplitude by slope * 2**-53: no less can be claimed."""
    K, A = branch.K.values[1:], branch.amplitude.values[1:]
    slope = np.abs(np.gradient(np.log(A), np.log(K)))
    least = slope * 2.0**-53
    error = branch.error.values[1:]
    assert slope.max() > 1e7
    assert (error > least).all()
    assert (error < np.maximum(1e-8, 1e3 * least)).all()


@pytest.mark.parametrize("parameter", ["V_lp", "b"])
def test_the_error_is_not_inflated_along_V_lp_or_b(parameter):
    """A stick-slip branch, which is not steep: the error is not inflated, and K's own slope is."""
    slider, exact = CYCLES["stick-slip"]
    start = {"V_lp": 1.5e-5, "b": 0.0078}[parameter]
    stop = {"V_lp": 1e-5, "b": 0.008}[parameter]
    slider, V_lp = slider_of(*slider)
    given = {} if parameter == "V_lp" else {"V_lp": V_lp}
    end = rs.continue_cycle(slider, parameter, start, stop, **given).isel(point=-1)
    assert end[parameter] == stop
    error = true_error(end, *exact)
    assert error <= end.error < min(1e-8, 300 * error + 1e-12)
