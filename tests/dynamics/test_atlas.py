"""The atlas, how far cycles and steady sliding coexist, and the pictures of both."""

import numpy as np
import pytest

import ratestate as rs
from ratestate import ParameterError, SpringSlider, limit_cycle
from ratestate.dynamics.atlas import atlas
from ratestate.dynamics.continuation.coexistence import folds
from ratestate.dynamics.cycles.attractor import find_attractors
from ratestate.dynamics.cycles.regimes import REGIMES, classify
from ratestate.dynamics.cycles.small_cycles import curvature
from ratestate.dynamics.cycles.system import one_length_system, small_amplitude, state
from ratestate.engine.model import FINISHED, STEADY_SLIDING
from ratestate.paper import atlas_figure as chart

LAWS = pytest.mark.parametrize("law", ["slip", "aging"])
N = 24


def dimensionless(law, b_over_a, eta, excess=0.0):
    """With V_lp = 1, a slider of this eta and K/K_c - 1."""
    slider = SpringSlider(a=1.0, b=b_over_a, Dc=1.0, sigma=1.0, M=eta, K=1.0, law=law)
    return slider.replace(K=float(slider.K_c(1.0)) * (1.0 + excess))


def system(law, kappa, beta, eta):
    columns = np.broadcast_arrays(kappa, beta, eta, np.inf)
    return one_length_system(law, *(np.array(column) for column in columns))


def excess(found, beta, eta):
    """K_fold/K_c - 1."""
    return found.kappa / ((beta - 1.0) * (1.0 + eta)) - 1.0


# coexistence


@pytest.mark.parametrize(("b_over_a", "eta"), [(1.2, 1e-2), (2.0, 0.1), (12.0, 0.094)])
def test_the_fold_is_where_a_branch_turns_back(b_over_a, eta):
    """Against pseudo-arclength continuation; the last one lies beyond the Bautin point."""
    slider = dimensionless("aging", b_over_a, eta, -0.03)
    branch = rs.continue_cycle(slider, "K", slider.K, 1.1 * slider.K, V_lp=1.0, rtol=1e-8)
    stiffest = float(branch.K.max())
    assert "fold" in branch.special.values[branch.K.values == stiffest]
    found = folds("aging", np.array([b_over_a]), np.array([eta]))
    width = float(excess(found, b_over_a, eta)[0])
    assert width == pytest.approx(stiffest / float(slider.K_c(1.0)) - 1.0, rel=1e-4)
    assert 1e-3 < width < 1e-2
    beyond = eta > rs.bautin("aging", b_over_a)
    assert str(rs.hopf(slider, 1.0).type.values) == ("supercritical" if beyond else "subcritical")


@pytest.mark.parametrize("eta", [1e-3, 0.05])
def test_a_small_unstable_cycle_parts_rest_from_vibration(eta):
    """Just above K_c swings smaller than the unstable cycle, of r^2 = margin/curvature, die out."""
    beta, r = 2.0, 4e-3  # of the aging law; in ln V
    edge = system("aging", 1.0 + eta, beta, np.array([eta]))
    margin = curvature("aging", edge.beta, edge.eta) * r**2
    here = system("aging", 1.0 + eta + margin, beta, edge.eta)
    assert here.margin == pytest.approx(margin, rel=0.1)
    u = np.ones((1, 2))
    u *= r / small_amplitude(here, u)
    for size, status in ((0.5, STEADY_SLIDING), (0.95, STEADY_SLIDING), (1.05, FINISHED)):
        assert find_attractors(here, state(here, size * u), 1e-6, None).status == status


def test_the_strip_closes_at_the_bautin_point():
    last = rs.bautin("aging", 2.0)
    eta = last * np.array([0.98, 0.99, 1.0, 1.01, 2.0, 1e4])
    width = excess(folds("aging", 2.0, eta), 2.0, eta)
    assert width[0] / width[1] == pytest.approx(4.0, rel=0.05)  # like the square of the distance
    assert np.isnan(width[2:]).all()
    # a degenerate one, with b/a some 7, comes before it outlives the bifurcation's change of type
    wide = rs.bautin("aging", 40.0) * np.array([1.0, 1.3, 1.6])
    width = excess(folds("aging", 40.0, wide), 40.0, wide)
    assert width[0] > width[1] > 0.0
    assert np.isnan(width[2])


@pytest.mark.parametrize("b_over_a", [1.2, 5.0])
def test_slip_law_has_no_cycle_beside_stable_sliding(b_over_a):
    assert np.isnan(folds("slip", b_over_a, np.geomspace(1e-6, 1e2, 20)).kappa).all()
    # nor is one reached from afar
    rng = np.random.default_rng(3)
    eta, above = 10.0 ** rng.uniform(-6, 1, 150), 10.0 ** rng.uniform(-3, -0.5, 150)
    psi, v = rng.uniform(-15, 15, 150), rng.uniform(-15, 5, 150)
    here = system("slip", (b_over_a - 1.0) * (1.0 + eta) * (1.0 + above), b_over_a, eta)
    start = np.stack([v + b_over_a * psi + rng.normal(size=150), v, psi], axis=1)
    found = find_attractors(here, start, 1e-6, lambda fraction: None)
    np.testing.assert_array_equal(found.status, STEADY_SLIDING)


def test_folds_of_a_batch_equal_those_found_alone():
    eta = np.array([1e-7, 1e-5, 1e-2, 0.13, 1.0])
    beta = np.array([2.0, 1.5, 5.0, 2.0, 3.0])
    together = folds("aging", beta, eta)
    assert np.isnan(together.kappa).tolist() == [True, False, False, False, True]
    for i in range(5):
        alone = folds("aging", beta[i : i + 1], eta[i : i + 1])
        np.testing.assert_allclose(alone.kappa, together.kappa[i : i + 1], rtol=1e-12)
    with pytest.raises(ParameterError, match="law"):
        folds("sloth", beta, eta)


# the atlas


@pytest.fixture(scope="module")
def charts():
    """law -> atlas, each computed once."""
    known = {}

    def of(law):
        if law not in known:
            known[law] = atlas(2.0, law, n=N)
        return known[law]

    return of


@LAWS
def test_variables_of_an_atlas(charts, law):
    data = charts(law)
    whole = ["amplitude_over_a", "slip_per_cycle", "frequency_over_f_n", "V_max_over_V_lp"]
    whole += ["inertia", "fundamental", "slow_fraction", "agree", "regime", "status"]
    for name in whole:
        assert data[name].dims == ("eta", "K_over_K_c_qs")
        assert data[f"{name}_close"].dims == ("eta", "K_over_K_c")
    for name in ("lyapunov_1_Dc_over_V_lp", "type", "K_c_over_K_c_qs", "K_fold_over_K_c_qs"):
        assert data[name].dims == ("eta",)
    for name, variable in data.variables.items():
        assert {"units", "long_name"} <= set(variable.attrs), name
    assert data.regime.dtype == data.status.dtype == np.int8
    meanings = data.regime.attrs["flag_meanings"].split()
    assert [name.replace("_", " ") for name in meanings] == list(REGIMES)
    assert data.b_over_a == 2.0
    assert data.attrs["law"] == law
    assert "eta_bautin" in str(rs.summary(data))


@LAWS
def test_boundary_and_bifurcation(charts, law):
    data = charts(law)
    np.testing.assert_allclose(data.K_c_over_K_c_qs, 1.0 + data.eta, rtol=1e-15)
    unstable = data.K_over_K_c_qs < data.K_c_over_K_c_qs
    reach = data.K_fold_over_K_c_qs.fillna(data.K_c_over_K_c_qs)
    settled = (data.status == 1).transpose(*unstable.dims)
    assert not settled.where(unstable, False).any()
    assert settled.where(data.K_over_K_c_qs > reach, True).all()
    assert (data.status_close == 0).all()
    steady = REGIMES.index("steady")
    np.testing.assert_array_equal(data.regime == steady, data.status == 1)
    assert (data.amplitude_over_a.where(data.status == 1, 0.0) == 0.0).all()
    turn_over = rs.bautin(law, 2.0)
    if law == "slip":
        assert np.isnan(turn_over)
        assert np.isnan(data.eta_bautin)
        assert (data.type == "supercritical").all()
        assert data.K_fold_over_K_c_qs.isnull().all()
    else:
        assert float(data.eta_bautin) == turn_over
        np.testing.assert_array_equal(data.type == "subcritical", data.eta < turn_over)
        strip = (data.eta > 1e-6) & (data.eta < turn_over)
        np.testing.assert_array_equal(data.K_fold_over_K_c_qs > data.K_c_over_K_c_qs, strip)
        assert 4 < strip.sum() < N
    np.testing.assert_array_equal(data.lyapunov_1_Dc_over_V_lp < 0, data.type == "supercritical")


def test_an_atlas_of_other_ranges():
    part = atlas(2.0, n=3, rtol=1e-4, eta=(0.1, 10.0), K_over_K_c_qs=(0.5, 2.0), transition=False)
    assert part.eta.values == pytest.approx([0.1, 1.0, 10.0])
    assert part.K_over_K_c_qs.values == pytest.approx([0.5, 1.0, 2.0])
    assert not any(name.endswith("_close") for name in part.variables)
    assert part.K_c_over_K_c_qs.values == pytest.approx([1.1, 2.0, 11.0])


def assert_same_cycle(here, suffix, cycle, slider, V):
    """Compare a point of an atlas with the cycle of a slider given in SI units."""
    expected = {
        "amplitude_over_a": cycle.amplitude / slider.a,
        "slip_per_cycle": V * cycle.period / slider.Dc,
        "frequency_over_f_n": cycle.frequency / slider.f_n,
        "V_max_over_V_lp": cycle.V_max / V,
        "inertia": cycle.inertia,
    }
    for name, value in expected.items():
        tolerance = {"rel": 1e-4, "abs": 1e-12, "nan_ok": True}
        assert float(here[name + suffix]) == pytest.approx(float(value), **tolerance), name
    assert REGIMES[int(here[f"regime{suffix}"])] == str(classify(cycle).regime.values)


@LAWS
def test_any_slider_is_a_point_of_the_atlas(charts, law):
    """One given in SI units, of the same b/a, at random points."""
    data = charts(law)
    rng = np.random.default_rng(4)
    for i, j in rng.integers(0, N, (8, 2)):
        for suffix, stiffness in (("", "K_over_K_c_qs"), ("_close", "K_over_K_c")):
            here = data.isel({"eta": i, stiffness: j % data.sizes[stiffness]})
            a, Dc, sigma, V = 10.0 ** rng.uniform([-3, -7, 4, -10], [-1.5, -2, 9, 1])
            slider = SpringSlider(a=a, b=2.0 * a, Dc=Dc, sigma=sigma, K=1.0, law=law)
            slider = slider.replace(M=float(here.eta) * a * sigma * Dc / V**2)
            unit = slider.K_c(V) if suffix else slider.K_c_qs
            slider = slider.replace(K=float(here[stiffness]) * float(unit))
            cycle = limit_cycle(slider, V, rtol=1e-6)
            assert_same_cycle(here, suffix, cycle, slider, V)


@pytest.mark.parametrize(
    ("law", "own", "M"),
    [
        ("two-state-aging", {"b2": 0.5, "Dc2": 0.2}, None),
        ("kato-tullis", {"V_cut": 3.0}, 1e-3),
    ],
)
def test_a_slider_of_a_law_with_parameters_is_a_point_of_its_atlas(law, own, M):
    """In SI units: b2 and Dc2 times a and Dc, and speeds times that which is 1 on the map."""
    settings = {} if M is None else {"M": M}
    data = atlas(2.0, law, n=8, rtol=1e-6, **settings, **own)
    rows = "eta" if M is None else "V_lp"
    assert data.regime.dims == (rows, "K_over_K_c_qs")
    assert np.isnan(data.eta_bautin)
    assert data.K_fold_over_K_c_qs.isnull().all()
    a, Dc, sigma, unit = 0.004, 2e-5, 3e6, 1e-4
    scales = {"b2": a, "Dc2": Dc, "c": 1.0, "V_cut": unit}
    own = {symbol: value * scales[symbol] for symbol, value in own.items()}
    slider = SpringSlider(a=a, b=2 * a, Dc=Dc, sigma=sigma, K=1.0, M=0.0, law=law, **own)
    speeds = np.ones(8) * unit if M is None else data.V_lp.values * unit
    largest = max(float(slider.K_c(V)) for V in speeds)
    for i, j in ((1, 1), (5, 0), (6, 3), (2, 6)):
        for suffix, stiffness in (("", "K_over_K_c_qs"), ("_close", "K_over_K_c")):
            here = data.isel({rows: i, stiffness: j % data.sizes[stiffness]})
            V = speeds[i]
            moving = slider.replace(M=float(here.eta) * a * sigma * Dc / V**2)
            moving = moving.replace(
                K=float(here[stiffness]) * (float(moving.K_c(V)) if suffix else largest)
            )
            cycle = limit_cycle(moving, V, rtol=1e-6)
            assert_same_cycle(here, suffix, cycle, moving, V)
        assert float(here.K_c_over_K_c_qs) == pytest.approx(moving.K_c(V) / largest, rel=1e-12)


def test_missing_parameters_of_an_atlas_are_named():
    for options, said in (
        ({"law": "kato-tullis", "V_cut": 1.0}, "has a characteristic speed.* Give M"),
        ({"law": "aging", "M": 1.0}, "'aging' has no characteristic speed.* Leave M out"),
        ({"law": "nagata"}, "needs c"),
        ({"law": "aging", "c": 1.0}, "c"),
        ({"law": "two-state-slip", "b2": -3.0, "Dc2": 1.0}, "stable at any stiffness"),
        ({"law": "two-state-slip", "b2": 0.5, "Dc2": "10 um"}, "Dc2 = '10 um' is not a plain"),
        ({"law": "kato-tullis", "V_cut": 1.0, "M": "1 kg/m^2"}, "M = '1 kg/m\\^2' is not a plain"),
        ({"law": "kato-tullis", "V_cut": 1.0, "M": 1e-3, "eta": (0.1, 1.0)}, "Leave eta out"),
        ({"law": "slip", "eta": 3}, "eta = 3 is not a pair of numbers"),
        ({"law": "slip", "K_over_K_c_qs": (1.0,)}, "such as K_over_K_c_qs=\\(0.1, 10\\)"),
        ({"law": "slip", "sigma": 2.0}, "sigma is not a parameter that law = 'slip' has beside"),
    ):
        with pytest.raises(ParameterError, match=said):
            atlas(2.0, n=4, **options)


@pytest.mark.parametrize(
    "options",
    [{"b_over_a": 1.0}, {"b_over_a": 0.5}, {"law": "sloth"}, {"n": 1}, {"n": 2.5}],
)
def test_bad_input(options):
    with pytest.raises(ParameterError):
        atlas(**options)


# pictures


@LAWS
def test_the_figure_of_an_atlas_looks_as_before(charts, law, looks_as_before):
    fig = chart.draw(charts(law))
    looks_as_before(fig, f"atlas_{law}")
    assert f"{law} (" in fig.get_suptitle()
    assert "= 2." in fig.get_suptitle()
    named = [text.get_text() for text in fig.axes[0].get_legend().get_texts()]
    assert any("supercritical" in name for name in named)
    for part in ("subcritical", "both stable"):
        assert any(part in name for name in named) == (law == "aging"), part
