"""What every friction law can do: runs, stability of steady sliding, limit cycles."""

import mpmath
import numpy as np
import pytest
import xarray as xr
from load_step import load_step
from textbook import OF_LAW, Textbook, drawn, drawn_of_form

import ratestate as rs
from ratestate.dynamics.cycles.limit_cycle import orbit
from ratestate.friction import normal_form
from ratestate.friction.composition import forms_of
from ratestate.friction.laws import LAWS, one_length_laws
from ratestate.friction.linear_stability import linearisation

NAMES = pytest.mark.parametrize("law", LAWS)
#: with one state, with two, and with a rate of state that depends on d tau/dt
THREE = pytest.mark.parametrize("law", ["aging", "two-state-slip", "nagata"])
RTOL = 1e-6
#: close to the edge of stability under each law, and driven at V
COMMON = {"a": 0.003, "b": 0.005, "Dc": 1e-5, "sigma": 2e6, "M": 3e3, "K": 3e8}
V = 1e-3
DAMPED, CUT_OFF = {"damping": 5e4}, {"friction_form": "cut-off", "V1": 1e-2, "V2": 1.0}
ONE_OF_EACH_KIND = [("aging", {}), ("two-state-slip", {}), ("nagata", {}), ("slip", DAMPED)]
MASSLESS = ("slip", DAMPED | {"M": 0.0})


def slider(law, **changes):
    return rs.SpringSlider(**(COMMON | OF_LAW[law] | changes), law=law)


def together(parameters):
    """Parameters of sliders, a list of dicts, as those of one sweep along `slider`."""
    return {s: xr.DataArray([p[s] for p in parameters], dims="slider") for s in parameters[0]}


@pytest.mark.parametrize(
    ("law", "form", "damped", "mass"),
    # (under flash heating slip reverses: test_reversal.py)
    [(law, "log", False, True) for law in LAWS if law != "flash-heating"]
    + [(law, "log", False, False) for law in ("prz", "nagata", "two-state-aging")]
    + [(law, "log", True, mass) for law in ("slip", "nagata") for mass in (True, False)]
    + [("slip", "cut-off", False, True), ("slip", "cut-off", True, False)],
)
def test_a_step_agrees_with_the_textbook(law, form, damped, mass):
    """By SciPy, in other variables: a step of the load point by a factor of 3.

    With damping and without mass, it leads through what would be an instability.
    """
    parameters, V = drawn_of_form(law, np.random.default_rng(8), form, damped)
    parameters |= {} if mass else {"M": 0.0, "K": (0.4 if damped else 3.0) * parameters["K"]}
    simulate, times, twin, exact = load_step(law, parameters, V)
    run = simulate(times=times, rtol=RTOL)
    assert twin.differs(run, exact) < 100 * RTOL
    finer = simulate(times=times, rtol=RTOL / 1e3)
    assert twin.differs(finer, exact) < 1e-3 * RTOL + 1e-7  # that of SciPy
    assert abs(float(finer.energy_residual)) < 1e-8


@NAMES
def test_a_start_may_have_any_part_of_its_state_given(law):
    """V, each state and tau, as they are given; without mass friction fixes the last one."""
    twin = Textbook(law, {"mu0": 0.6, "V0": 1e-6} | COMMON | OF_LAW[law])
    names = list(LAWS[law].states)
    theta = [0.7 * D / V for D in twin.D]
    given = {"V": 0.4 * V, **dict(zip(names, theta, strict=True))}
    loading = rs.Loading.constant(V)
    run = rs.simulate(slider(law), loading, 1e-6, initial=given | {"tau": 1.1e6}, times=[0.0])
    assert float(run.tau[0]) == pytest.approx(1.1e6, rel=1e-14)
    balance = 2e6 * twin.mu(0.4 * V, theta)
    light = slider(law, M=0.0)
    still = rs.simulate(light, loading, 1e-6, initial=given, times=[0.0])
    assert float(still.tau[0]) == pytest.approx(balance, rel=1e-13)
    with_tau = {key: x for key, x in given.items() if key != "V"} | {"tau": balance}
    by_tau = rs.simulate(light, loading, 1e-6, initial=with_tau, times=[0.0])
    first = {key: x for key, x in given.items() if key != "theta"} | {"tau": balance}
    by_state = rs.simulate(light, loading, 1e-6, initial=first, times=[0.0])
    for start in (run, still, by_tau, by_state):
        for name, value in given.items():
            assert float(start[name][0]) == pytest.approx(value, rel=1e-11), name
    state = {"theta": theta[0]}  # of which the speed is the usual one
    usual = rs.simulate(slider(law), loading, 1e-6, V_start=0.4 * V, initial=state, times=[0.0])
    assert float(usual.V[0]) == pytest.approx(0.4 * V, rel=1e-11)
    assert float(usual.theta[0]) == pytest.approx(theta[0], rel=1e-11)
    with pytest.raises(rs.ParameterError, match="do not agree: without inertia"):
        rs.simulate(light, loading, 1e-6, initial=given | {"tau": 1.01 * balance})


@NAMES
def test_a_rigid_spring_is_the_limit_of_a_stiff_one(law):
    """K = inf: where the law knows the state in closed form, and where it is integrated."""
    loading = rs.Loading.series([0.0, 0.05, 0.05, 0.1, 0.3], [1e-4, 1e-4, 1e-3, 3e-3, 3e-3])
    times = [0.02, 0.06, 0.08, 0.12, 0.3]
    stiff, rigid = (
        rs.simulate(slider(law, K=K, M=0.0), loading, 0.3, times=times, rtol=1e-9)
        for K in (1e14, np.inf)
    )
    for name in ("mu", *LAWS[law].states):
        np.testing.assert_allclose(rigid[name], stiff[name], rtol=2e-5, err_msg=name)
    assert float(rigid.mu_min) == pytest.approx(float(stiff.mu_min), rel=2e-5)


@pytest.mark.parametrize(
    ("law", "form"), [(name, form) for name, law in LAWS.items() for form in forms_of(law)]
)
@pytest.mark.parametrize("damped", [False, True])
def test_eigenvalues_agree_with_the_textbook(law, form, damped):
    """By central differences, on sliders with mass; on both sides of K_c."""
    rng = np.random.default_rng(9)
    for _ in range(3):
        parameters, V = drawn_of_form(law, rng, form, damped)
        twin, case = Textbook(law, parameters), rs.SpringSlider(**parameters, law=law)
        exact = np.linalg.eigvals(twin.jacobian(twin.steady(V), V))
        found = rs.stability(case, V).eigenvalues.values
        assert len(found) == len(exact)
        assert (np.diff(found.real) <= 0).all()
        for value in found:
            near = exact[np.argmin(np.abs(exact - value))]
            assert abs(near - value) < 1e-6 * abs(value) + 1e-9 * np.abs(exact).max()
        K_c = case.K_c(V)
        if K_c > 0:
            both = case.replace(K=xr.DataArray([K_c * (1.0 + 1e-9), K_c * (1.0 - 1e-9)], dims="K"))
            assert rs.stability(both, V).stable.values.tolist() == [True, False]


@pytest.mark.parametrize("V", 10.0 ** np.arange(-30, 5, 5))
def test_eigenvalues_of_two_states_have_their_digits_at_any_speed(V):
    """Those of eta L + 1 + kappa/L = sum r s/(L + s), to 1e-9 each, over 50 orders of magnitude."""
    case = slider("two-state-slip")
    with mpmath.workdps(300):
        eta, kappa = (
            mpmath.mpf(float(case.eta(V))),
            mpmath.mpf(case.K * case.Dc) / (case.a * case.sigma),
        )
        (r, s), (r2, s2) = (case.b / case.a, 1.0), (case.b2 / case.a, case.Dc / case.Dc2)
        r, s, r2, s2 = map(mpmath.mpf, (r, s, r2, s2))
        whole = [eta, 1 + eta * (s + s2), eta * s * s2 + s + s2 + kappa, s * s2 + kappa * (s + s2)]
        whole[2] -= r * s + r2 * s2
        whole[3] -= (r + r2) * s * s2
        whole = [kappa * s * s2, *reversed(whole)]
        exact = mpmath.polyroots(whole, maxsteps=500, extraprec=3000, asc=True)
        exact = np.array([complex(z) for z in exact]) * V / case.Dc
    found = rs.stability(case, V).eigenvalues.values
    for z in exact:
        assert np.abs(found - z).min() < 1e-9 * abs(z)


@THREE
def test_critical_stiffness_and_speeds_are_where_eigenvalues_cross(law):
    """On both sides of each; the slider's and the function's are one."""
    rng = np.random.default_rng(10)
    parameters, V = zip(*(drawn(law, rng) for _ in range(30)), strict=True)
    V = xr.DataArray(list(V), dims="slider")
    case = rs.SpringSlider(**together(parameters), law=law)
    found, K_c = rs.stability(case, V), case.K_c(V)
    np.testing.assert_allclose(K_c, found.K_c, rtol=1e-10)
    np.testing.assert_array_equal(found.stable, found.growth_rate < 0)
    may = (K_c > 0).values
    stiffer, edge, softer = (
        rs.stability(case.replace(K=np.abs(f * K_c)), V)[{"slider": may}]
        for f in (1 + 1e-6, 1.0, 1 - 1e-6)
    )
    assert (stiffer.growth_rate < 0).all()
    assert (softer.growth_rate > 0).all()
    turns = (edge.omega > 0).values
    assert may.sum() > 10
    assert turns.sum() > 5
    np.testing.assert_allclose(edge.omega[turns], found.omega_c[may][turns], rtol=1e-6)
    count = 0
    for speed, sign in ((case.V_c, 1), (case.V_c_upper, -1)):
        there = ((speed > 0) & (speed < 1e6)).values
        count += there.sum()
        below, above = (
            rs.stability(case, (f * speed).where(there, V)).growth_rate[there]
            for f in (1 - 1e-6, 1 + 1e-6)
        )
        assert (sign * below < 0).all()
        assert (sign * above > 0).all()
    assert ((case.V_c < case.V_c_upper) | (case.V_c_upper == np.inf)).all()
    assert count > 5


def test_sliding_may_be_stable_below_both_edges():
    """A spring that is soft enough for the second pair of roots to be stable again."""
    shares = {"a": 0.01, "b": 0.0189, "b2": -0.009, "Dc2": 2e-5}
    soft = slider("two-state-aging", **shares, K=1.86e6, M=1e3, sigma=5e6)
    speeds = rs.logspace("V_lp", 1e-10, 1e2, 25)
    stiff = rs.stability(soft.replace(K=0.5 * soft.K_c_qs), speeds)
    found = rs.stability(soft, speeds)
    np.testing.assert_array_equal(found.stable, found.growth_rate < 0)
    np.testing.assert_array_equal(stiff.stable, stiff.growth_rate < 0)
    assert bool(found.stable.all())
    assert (soft.V_c, soft.V_c_upper) == (np.inf, np.inf)
    assert float(stiff.V_c) == 0.0
    np.testing.assert_array_equal(stiff.stable, speeds > stiff.V_c_upper)


def test_neither_weakening_nor_strengthening_is_stable():
    """b = a: friction in steady sliding is the same at all speeds, whatever the rounding."""
    for law in LAWS:
        own = {"b2": 0.0} if "b2" in OF_LAW[law] else {}
        neutral = slider(law, a=0.01, b=0.01, **own)
        # (of these the state relaxes otherwise at each speed, and friction weakens by heat)
        if law not in ("kato-tullis", "flash-heating"):
            assert neutral.K_c(V) == 0.0, law
            assert str(rs.hopf(neutral, V).type.values) == "none"


@THREE
def test_a_slider_without_mass_on_a_soft_spring_runs_away(law):
    """With the same exception by all laws, and the run up to there."""
    own = {"b2": 0.001} if "b2" in OF_LAW[law] else {}
    light = slider(law, M=0.0, K=2e6, b=0.008, **own)
    with pytest.raises(rs.QuasiStaticInstability, match="V grows without bound") as error:
        rs.simulate(light, rs.Loading.constant(V), 1e3, V_start=V / 10)
    assert float(error.value.best.time[-1]) > 0.01


def test_critical_stiffness_depends_on_the_speed_under_a_law_with_one_of_its_own():
    case = slider("kato-tullis")
    with pytest.raises(rs.ParameterError, match="K_c_qs depends on the speed"):
        _ = case.K_c_qs
    slow, fast = (float(rs.stability(case, v).K_c_qs) for v in (1e-9, 1.0))
    assert fast == pytest.approx(slider("slip").K_c_qs, rel=1e-12)
    # far below V_cut ln(V theta/Dc) is W(1) = 0.567..., and theta relaxes 1 + W(1) times as fast
    assert slow == pytest.approx(1.5671432904097838 * fast, rel=1e-4)


@pytest.mark.parametrize(("law", "own"), ONE_OF_EACH_KIND)
def test_small_cycles_agree_with_the_hopf_point(law, own):
    """By its type and amplitude_coefficient, along K and V_lp; and how fast all else fades."""
    case = slider(law, K=6e8, **own)
    by_K = rs.hopf(case, 3e-3)
    assert float(by_K.K_c) == pytest.approx(case.K_c(3e-3), rel=1e-12)
    assert str(by_K.type.values) == "supercritical"
    below = rs.limit_cycle(case.replace(K=float(by_K.K_c) * (1 - 1e-3)), 3e-3)
    expected = np.sqrt(1e-3) * float(by_K.amplitude_coefficient)
    assert float(below.amplitude) == pytest.approx(expected, rel=5e-3)
    at_edge = rs.stability(case.replace(K=float(by_K.K_c)), 3e-3).eigenvalues.values
    others = at_edge[np.abs(at_edge.imag) < 0.5 * float(by_K.omega_c)]
    assert float(by_K.eigenvalue_3) == pytest.approx(others.real.max(), rel=1e-9)
    by_V = rs.hopf(case)
    assert float(by_V.V_c) == case.V_c
    if 0 < case.V_c < np.inf:
        cycle = rs.limit_cycle(case, float(by_V.V_c) * (1 + 1e-3))
        expected = np.sqrt(1e-3) * float(by_V.amplitude_coefficient)
        assert float(cycle.amplitude) == pytest.approx(expected, rel=5e-3)


def test_the_numbers_of_any_law_are_the_closed_form_of_one_length():
    """lyapunov_1 and growth rates, from no inertia at all to much of it, within their rounding."""
    for name in one_length_laws():
        law = LAWS[name]
        b1, eta = (x.ravel() for x in np.meshgrid([0.01, 0.3, 30.0], [0.0, 1e-6, 0.3, 20.0]))
        p = (1 + b1, *[0.0] * (law.n_coefficients - 1))
        kappa, omega = b1 * (1 + eta), np.sqrt(b1)
        found, rounding = normal_form.lyapunov_1_of_law(law, p, kappa, eta, omega)
        exact, _ = normal_form.lyapunov_1(eta, b1, *normal_form.law_curvatures(name))
        assert (np.abs(found - exact) < rounding).all()
        visible = eta > 0.1
        np.testing.assert_allclose(found[visible], exact[visible], rtol=1e-13)
        by_K, by_V = normal_form.growth_slopes(linearisation(law, p), kappa, eta, omega)
        fastest = b1 / ((1 + eta) ** 2 + b1 * eta**2)
        np.testing.assert_allclose(by_K, -0.5 * (1 + eta) * fastest, rtol=1e-13)
        np.testing.assert_allclose(by_V, eta * fastest, rtol=1e-13)


@pytest.mark.parametrize(("law", "own"), [*ONE_OF_EACH_KIND, ("slip", CUT_OFF), MASSLESS])
def test_a_limit_cycle_is_where_a_long_run_ends(law, own):
    """With as many multipliers as states, and one more; amplitude, period and speeds."""
    case = slider(law, K=2e8, **own)
    cycle = rs.limit_cycle(case, V)
    run = rs.simulate(case, rs.Loading.constant(V), 20.0, V_start=V / 10, times=[20.0], rtol=1e-9)
    assert int(cycle.status) == 0
    assert cycle.sizes["multiplier"] == 1 + len(LAWS[law].states)
    assert float(cycle.error) < 1e-8
    assert float(run.amplitude) == pytest.approx(float(cycle.amplitude), rel=1e-7)
    assert float(run.frequency) == pytest.approx(float(cycle.frequency), rel=1e-7)
    around = orbit(case, V)
    assert np.ptp(around.tau.values) / 2e6 == pytest.approx(float(cycle.amplitude), rel=1e-5)
    for name in ("tau", *LAWS[law].states):
        start, end = np.log(around[name].values[[0, -1]])
        assert end == pytest.approx(start, abs=1e-6), name


def test_multipliers_of_two_equal_states():
    """Equal distances: the map has those of one state, and how fast a difference of both fades."""
    two = rs.limit_cycle(slider("two-state-slip", b=0.003, b2=0.002, Dc2=1e-5), V)
    one = rs.limit_cycle(slider("slip"), V)
    assert float(two.amplitude) == pytest.approx(float(one.amplitude), rel=1e-9)
    assert float(two.period) == pytest.approx(float(one.period), rel=1e-9)
    slip = V * float(one.period) / 1e-5  # a difference decays by e over each Dc of slip
    found = np.sort(np.abs(two.multipliers.values))[::-1]
    expected = np.sort(np.append(np.abs(one.multipliers.values), np.exp(-slip)))[::-1]
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-6)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-3, atol=1e-9)
