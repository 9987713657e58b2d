"""The paper's figures: their numbers against the paper and quad precision, and their files."""

import numpy as np
import pytest
import xarray

import ratestate as rs
from ratestate import files, plot
from ratestate.paper import basins, branches, figures
from ratestate.paper.fig4 import FIG4, steepest

LAWS = ["slip", "aging"]
#: (number, law) of each picture: of the aging law two, one of them with folds
PICTURES = [
    *((number, "slip") for number in figures.FIGURES if number != "branches"),
    ("4", "aging"),
    ("branches", "aging"),
]


@pytest.fixture(scope="module")
def numbers():
    """(number, law) -> Dataset, each computed once."""
    known = {}

    def of(number, law):
        if (number, law) not in known:
            known[number, law] = figures.FIGURES[number].compute(law)
        return known[number, law]

    # fewer speeds than the figures have: they show all that can go wrong
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(basins, "SPEEDS", (0.8, 0.95, 2))
        patch.setattr(basins, "STIFFNESS", (*basins.STIFFNESS[:2], 5))
        patch.setattr(branches, "SPEEDS", (1.1, 0.6))
        yield of


def test_fig1_direct_effect_evolution_and_length(numbers):
    a, b, mu0, Dc = 0.003, 0.004, 0.6, 10e-6
    data = numbers("1", "slip").isel(time=slice(1, None))  # from just before the step
    for law in LAWS:
        run = data.sel(law=law)
        assert float(run.mu[0]) == pytest.approx(mu0, abs=1e-12)
        assert float(run.mu[1] - run.mu[0]) == pytest.approx(a, abs=1e-12)
        left = (run.mu - (mu0 + a - b)).values[1:] / b
        slip = run.slip.values[1:] / Dc
        assert slip[0] == 0.0
        assert np.abs(slip - 1.0).min() < 1e-9
        decay = np.exp(-slip)
        # both laws in closed form, for an e-fold step
        exact = decay if law == "slip" else np.log1p((np.e - 1.0) * decay)
        np.testing.assert_allclose(left, exact, atol=1e-9)


@pytest.mark.parametrize(
    ("law", "amplitude", "V_min", "V_max"),
    [("slip", 1.234696554e-3, 2.779e-3, 3.651e-3), ("aging", 2.2991965811e-3, None, None)],
)
def test_fig2_fate_of_three_steps(numbers, law, amplitude, V_min, V_max):
    data = numbers("2", law)
    np.testing.assert_allclose(data.amplitude[:2], 0.0, atol=1e-7)
    assert float(data.amplitude[2]) == pytest.approx(amplitude, rel=1e-5)
    end = data.sel(time=slice(9.9, None))
    swing = (end.tau.max("time") - end.tau.min("time")) / 2e6
    assert float(swing[2]) == pytest.approx(amplitude, rel=1e-2)  # 40 samples a cycle
    if V_min:
        assert float(end.V[2].min()) == pytest.approx(V_min, abs=2e-6)
        assert float(end.V[2].max()) == pytest.approx(V_max, abs=2e-6)
    np.testing.assert_array_equal(data.K_c > 900e6, [False, False, True])
    eta = 3000.0 * data.V_lp**2 / 0.06
    np.testing.assert_allclose(data.K_c, 600e6 * (1 + eta), rtol=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_fig3_all_cases_on_their_side_of_V_c(numbers, law):
    data = numbers("3", law)
    assert data.amplitude.sizes == {"M": 12, "V_lp": 13}
    above = (data.V_lp > data.V_c).transpose("M", "V_lp").values
    assert 0 < above.sum() < 156
    np.testing.assert_array_equal(data.unstable, above)
    np.testing.assert_array_equal(data.stable, ~above)
    np.testing.assert_array_equal(data.cycle_status, np.where(above, 0, 1))
    # eq. 10 at M = 3000 gives 3.162 mm/s
    np.testing.assert_allclose(data.V_c, np.sqrt(0.06 / data.M * 0.5), rtol=1e-12)
    gap = np.abs(data.amplitude - data.cycle_amplitude).values
    far = above & (data.V_lp > 1.2 * data.V_c).transpose("M", "V_lp").values
    assert gap[far].max() < 1e-4  # at 10 s these have settled


def test_fig4_amplitudes_and_the_coefficient(numbers):
    stiff = numbers("4", "slip").sel(K=0.96e9)
    known = {
        1e-4: (0.04696781, 0.4192088),
        1e-2: (0.01899449, 74.91234),
        1e-1: (0.02583319, 380.3364),
        1.0: (0.1654362, 487.4721),
    }
    for V_lp, (amplitude, frequency) in known.items():
        cycle = stiff.sel(V_lp=V_lp)
        assert float(cycle.amplitude) == pytest.approx(amplitude, rel=1e-6)
        assert float(cycle.frequency) == pytest.approx(frequency, rel=1e-6)
    aging = numbers("4", "aging").sel(K=0.96e9, V_lp=1e-2)
    assert float(aging.amplitude) == pytest.approx(0.03625932, rel=1e-6)
    assert float(aging.frequency) == pytest.approx(53.27594, rel=1e-6)
    one = np.exp(np.interp(0.0, np.log(stiff.eta), np.log(stiff.V_lp)))
    assert one == pytest.approx(4.472e-2, rel=1e-4)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ["stick_slip", "harmonic"])
def test_fig4_examples_have_settled(numbers, law, name):
    data = numbers("4", law)
    run = data[f"tau_{name}"] / 4e6
    slider = FIG4.replace(law=law)
    cycle = rs.limit_cycle(slider, V_lp=float(data[f"V_lp_{name}"]))
    # the solver's steps come near the extremes, and never pass them
    missed = float(cycle.amplitude - (run.max() - run.min()))
    assert -1e-6 * float(cycle.amplitude) < missed < 1e-3 * float(cycle.amplitude)
    gap = abs(run - data[f"mu_{name}"]).max() / cycle.amplitude
    assert float(gap) == pytest.approx(float(cycle.inertia), rel=2e-2)


@pytest.mark.parametrize("law", LAWS)
def test_fig5_frequency_stays_below_the_natural(numbers, law):
    data = numbers("5", law)
    np.testing.assert_allclose(data.f_n, [493.1, 389.8], atol=0.06)
    share = data.frequency / data.f_n
    assert float(share.max()) < 1.0
    assert (share.isel(V_lp=-1) > 0.998).all()
    assert (data.frequency.diff("V_lp") > 0).all()


@pytest.mark.parametrize(
    ("law", "amplitude", "frequency"),
    [("slip", 0.00569786, 2.962584), ("aging", 0.01961776, 2.222700)],
)
def test_fig6_limit_cycle(numbers, law, amplitude, frequency):
    data = numbers("6", law)
    for prefix, rtol in (("", 5e-6), ("cycle_", 1e-6)):
        assert float(data[f"{prefix}amplitude"]) == pytest.approx(amplitude, rel=rtol)
        assert float(data[f"{prefix}frequency"]) == pytest.approx(frequency, rel=rtol)
    assert float(data.eta) == pytest.approx(0.002, rel=1e-12)
    assert 1.0005 * float(data.K_c_qs / data.K_c) == pytest.approx(0.9985, abs=5e-5)
    settled = data.isel(time=data.settled)
    swing = float(settled.tau.max() - settled.tau.min()) / 2e6
    assert swing == pytest.approx(amplitude, rel=1e-3)


@pytest.mark.parametrize(("number", "law"), PICTURES)
def test_drawing_from_a_file_alone(numbers, number, law, tmp_path, looks_as_before):
    data = numbers(number, law)
    if law == "slip":
        again = files.read(files.write(data, tmp_path / "numbers.nc"))
        xarray.testing.assert_equal(data, again)
        data = again
    fig = figures.FIGURES[number].draw(data)
    looks_as_before(fig, figures.FIGURES[number].stem(law))
    for name, variable in data.variables.items():
        assert name == "law" or {"units", "long_name"} <= set(variable.attrs), name
    fig.savefig(tmp_path / "figure.png", dpi=40)  # warnings, which are errors here, come late
    assert figures.FIGURES[number].both_laws or f"{law} (" in fig.get_suptitle()


def test_make_writes_png_pdf_and_nc_of_a_figure(tmp_path):
    paths = figures.make("1", "slip", tmp_path / "new")
    assert [path.name for path in paths] == ["fig1.png", "fig1.pdf", "fig1.nc"]
    assert sorted(paths) == sorted((tmp_path / "new").iterdir())
    assert paths[0].read_bytes()[:4] == b"\x89PNG"
    assert paths[1].read_bytes()[:4] == b"%PDF"
    bare = figures.make("1", "slip", tmp_path / "bare", title=False)
    assert paths[0].read_bytes() != bare[0].read_bytes()
    assert [figures.FIGURES["2"].stem(law) for law in LAWS] == ["fig2_slip", "fig2_aging"]


def test_units_of_labels():
    assert plot.prefixed("m/s", 3.2e-3) == (1e3, "mm/s")
    assert plot.prefixed("m", 1e-5)[0] == 1e6
    assert plot.prefixed("s", 0.0) == (1.0, "s")
    assert plot.prefixed("m/s", 1e-12) == (1e9, "nm/s")
    assert plot.prefixed("m/s", 1e-14) == (1.0, "m/s")
    assert plot.prefixed("s", 7000.0) == (1.0, "s")
    assert plot.prefixed("s", 5e9) == (pytest.approx(1 / 31_557_600), "years")
    assert plot.value_text("K", np.inf) == r"$K$ = $\infty$"
    assert plot.value_text("K", 900e6) == "$K$ = 900 MPa/m"
    assert plot.value_text("K", 0.96e9, unit_of=1e9) == "$K$ = 0.96 GPa/m"
    assert plot.value_text("sigma", 8e6, area=25e-4) == "$F_n$ = 20 kN"
    assert plot.value_text("a", 0.003) == "$a$ = 0.003"


def test_steepest_fall_is_at_time_0():
    time = np.linspace(0.0, 10.0, 1001)
    tau = xarray.DataArray(-np.tanh(time - 6.0), {"time": time}, ("time",))
    run = steepest(xarray.Dataset({"tau": tau}))
    assert float(run.tau.sel(time=0.0)) == pytest.approx(0.0, abs=1e-12)
