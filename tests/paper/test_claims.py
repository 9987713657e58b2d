"""The claims table and the paper's scheme: the paper's numbers, and those of numerics.md."""

import json
import math

import numpy as np
import pytest
import xarray
from numpy.polynomial.chebyshev import Chebyshev, chebpts1
from rich.console import Console

from ratestate import ParameterError, SolverError, limit_cycle, stability
from ratestate.paper import claims_cycles, claims_steps, claims_table, scheme
from ratestate.paper.claim import Claim, exact, pair, statements, to_digits
from ratestate.paper.claims_table import claims
from ratestate.paper.fig3 import UNSTABLE
from ratestate.paper.parameters import FIG2, FIG2_START, FIG4, FIG6
from ratestate.paper.scheme import critical_velocity, multiplier, step_response, time_step

#: claims of the 156 cases of Fig. 3
CASES = ("cases_at_10_s", "cases_converged")


@pytest.fixture(scope="module")
def rows():
    """id -> row, of the table for the slip law, but for `CASES`, which are statistics."""
    table = claims(
        "slip", [part for part in claims_table.MEASUREMENTS if part is not claims_steps.on_map]
    )
    assert [row.id for row in table] == [one for one in statements() if one not in CASES]
    assert len(table) >= 30
    return {row.id: row for row in table}


#: id -> what the paper's text gives, or what numerics.md has converged, to a relative 1e-6
CONVERGED = {
    "direct_effect": (0.003,),
    "evolution_effect": (0.004,),
    "evolution_distance": (10.0,),
    "net_change": (-0.001,),
    "K_c_qs": (600.0,),
    "V_c": (math.sqrt(10.0),),
    "cycle_range": (2.7786482, 3.6515032),
    "eta_1": (100 * math.sqrt(0.002),),
    "f_n": (math.sqrt(0.96e7) / (2 * math.pi), math.sqrt(0.60e7) / (2 * math.pi)),
    "eta_fig6": (0.002,),
    "K_over_K_c_fig6": (1.0005 / 1.002,),
    "slow_cycle": (0.00569786,),
}


@pytest.mark.parametrize("name", CONVERGED)
def test_converged_values(rows, name):
    np.testing.assert_allclose(rows[name].converged, CONVERGED[name], rtol=1e-6)
    assert rows[name].error <= 1e-6 * abs(CONVERGED[name][0])


def test_verdicts(rows):
    others = {
        "cycle_range": "agrees with the scheme only",
        "minimum_0.96": "agrees with the scheme only",
        "first_drop_inertia": "differs",
    }
    assert {name: row.verdict for name, row in rows.items()} == dict.fromkeys(
        rows, "agrees"
    ) | others


def test_ranges_of_the_papers_phrases(rows):
    """No wider than the phrase allows: each is a range that a value well beside it leaves."""
    phrases = {
        "slope": (-math.inf, 0.0),
        "log_linear": (0.0, 0.05),
        "log_linear_in_frequency": (0.0, 0.05),
        "all_cycles": (1.0, 1.0),
        "eta_at_minimum": (0.1, 10.0),
        "growth": (2.0, math.inf),
        "frequency_limit": (0.99, 1.0),
        "frequency_rises": (0.0, math.inf),
    }
    assert {name: rows[name].covers for name in phrases} == {
        name: (covered, covered) for name, covered in phrases.items()
    }


def test_the_smallest_amplitude_lies_between_velocities_of_the_sweep(rows):
    """Where the derivative of a polynomial through Chebyshev nodes about it is 0."""
    for K, near in ((0.96e9, 0.0237), (0.60e9, 0.0429)):
        nodes = chebpts1(9)
        V = xarray.DataArray(near * np.exp(0.05 * nodes), dims="V_lp")
        amplitude = limit_cycle(FIG4.replace(K=K), V, rtol=1e-11).amplitude
        turns = Chebyshev.fit(nodes, amplitude, 6).deriv().roots()
        (at,) = turns[(np.abs(turns.imag) < 1e-9) & (np.abs(turns) < 1.0)].real
        found = rows[f"minimum_{K / 1e9:.2f}"]
        assert found.converged[0] == pytest.approx(100.0 * near * np.exp(0.05 * at), rel=2e-6)
        assert found.error < 2e-4
        smallest = np.polynomial.chebyshev.chebval(at, Chebyshev.fit(nodes, amplitude, 6).coef)
        above = limit_cycle(FIG4.replace(K=K), 0.03, rtol=1e-11).amplitude / smallest - 1.0
        assert f"at 3 cm/s the amplitude is {100 * above:.1f} % above it" in found.note


def test_values_that_the_paper_gives_in_words(rows):
    def converged(name):
        return rows[name].converged

    np.testing.assert_allclose(converged("slope"), [-0.01453, -0.01477], rtol=1e-3)
    assert 2.3 < converged("minimum_0.96")[0] < 2.45 < 4.2 < converged("minimum_0.60")[0] < 4.4
    assert all(0.999 < ratio < 1.0 for ratio in converged("frequency_limit"))
    # amplitude at 1 m/s (numerics.md) over a smallest one of 0.0170
    assert converged("growth")[0] == pytest.approx(0.1654362 / 0.0170, rel=2e-3)
    assert converged("step_to_3.1")[0] < 1e-8 < 1e-3 < converged("step_to_3.2")[0] < 1.3e-3
    assert converged("inertia_in_stick_slip")[0] == pytest.approx(7.0e-4, rel=0.02)
    assert converged("inertia_in_harmonic")[0] == pytest.approx(0.983, rel=0.01)
    assert converged("slow_inertia")[0] == pytest.approx(0.00376, rel=0.01)
    assert converged("first_drop_inertia")[0] == pytest.approx(0.426, rel=0.01)


def test_one_bound_parts_steady_from_unstable(rows):
    """In the figure, and in the ranges of claims.toml."""
    assert rows["step_to_0.3"].covers == rows["step_to_3.1"].covers == ((0.0, UNSTABLE),)
    assert rows["step_to_3.2"].covers == ((UNSTABLE, math.inf),)


def test_the_scheme_is_the_cause_where_the_table_says_so(rows):
    """Its error shrinks with its step, towards the converged value."""
    for name in ("V_c", "cycle_range", "step_to_3.2"):
        row = rows[name]
        (coarse, fine), truth = row.scheme.values(), np.array(row.converged)
        assert (np.abs(np.array(fine) - truth) < 0.55 * np.abs(np.array(coarse) - truth)).all()
    steps = rows["V_c"].scheme
    assert [step[0] for step in steps] == [0.1, 0.01]
    assert [step[1] for step in steps] == pytest.approx([1.8257e-4, 1.8257e-5], rel=1e-3)
    assert not rows["step_to_3.1"].holds(next(iter(rows["step_to_3.1"].scheme.values())))


def test_aging_law():
    """Where the laws share an answer they agree; the paper's slip-law numbers are not judged."""
    parts = [claims_steps.on_friction, claims_steps.on_steps, claims_cycles.on_slow_slip]
    rows = {row.id: row for row in claims("aging", parts)}
    verdicts = {name: row.verdict for name, row in rows.items() if row.verdict != "agrees"}
    assert verdicts == {
        "evolution_distance": "differs",
        "cycle_range": "no value given",
        "slow_inertia": "differs",
        "first_drop_inertia": "differs",
    }
    exact_distance = 10 * math.log((math.e - 1) / math.expm1(1 / math.e))
    assert rows["evolution_distance"].converged[0] == pytest.approx(exact_distance, rel=1e-5)
    np.testing.assert_allclose(rows["cycle_range"].converged, [2.427052, 4.046977], rtol=1e-6)
    assert rows["slow_cycle"].converged[0] == pytest.approx(0.01961776, rel=1e-6)
    by_scheme = [V_c for (V_c,) in rows["V_c"].scheme.values()]  # as published: backward Euler
    assert by_scheme == pytest.approx([EULER[0.1], EULER[0.01]], rel=1e-3)
    assert not any(row.paper for row in rows.values() if row.verdict == "no value given")


# numerics.md, section 4: omega dt -> V_c [mm/s]
EXACT_STATE = {0.1: 2.84, 0.05: 2.99, 0.02: 3.09, 0.01: 3.126}
EULER = {0.1: 2.987, 0.05: 3.073, 0.02: 3.126, 0.01: 3.144}


@pytest.mark.parametrize(
    ("law", "euler", "expected"),
    [("slip", False, EXACT_STATE), ("aging", False, EXACT_STATE), ("aging", True, EULER)],
)
def test_critical_velocity_of_the_scheme(law, euler, expected):
    slider = FIG2.replace(law=law)
    for omega_dt, V_c in expected.items():
        assert 1e3 * critical_velocity(slider, omega_dt, euler) == pytest.approx(V_c, rel=0.01)
    # order 1: the error is proportional to the step
    error = [1 - critical_velocity(slider, od, euler) / slider.V_c for od in (0.01, 0.005)]
    assert error[0] / error[1] == pytest.approx(2.0, rel=0.02)


def test_critical_velocity_beyond_the_search(monkeypatch):
    """Where it turns below 0.2 or above 1.05 V_c is an error, and no end of the search."""
    assert 0.2 < critical_velocity(FIG6, 0.1) / FIG6.V_c < 1.05
    with pytest.raises(SolverError, match=r"is unstable .* = 0\.2 V_c if omega dt = 1\."):
        critical_velocity(FIG6, 1.0)
    monkeypatch.setattr(scheme, "multiplier", lambda *_: 0.999)
    with pytest.raises(SolverError, match=r"is stable .* = 1\.05 V_c if omega dt = 0\.1\."):
        critical_velocity(FIG2, 0.1)


def test_critical_velocity_without_a_critical_one():
    assert critical_velocity(FIG2.replace(K=0.5 * FIG2.K_c_qs), 0.1) == 0.0
    assert critical_velocity(FIG2.replace(b=0.5 * FIG2.a), 0.1) == np.inf


@pytest.mark.parametrize(
    ("omega_dt", "V_min", "V_max"),
    [
        (1 / 10, 1.93, 4.80),
        (1 / 20, 2.23, 4.35),
        (1 / 40, 2.44, 4.06),
        (1 / 80, 2.58, 3.88),
        (1 / 320, 2.72, 3.72),
    ],
)
def test_limit_cycle_of_the_scheme(omega_dt, V_min, V_max):
    run = step_response(FIG2, FIG2_START, 3.2e-3, 10.0, omega_dt)
    assert 1e3 * float(run.V.min()) == pytest.approx(V_min, rel=0.01)
    assert 1e3 * float(run.V.max()) == pytest.approx(V_max, rel=0.01)
    np.testing.assert_allclose(np.diff(run.time), time_step(FIG2, omega_dt), rtol=1e-6)


def test_the_multiplier_tends_to_the_growth_rate():
    """exp(growth rate * dt), once the scheme's error of order dt is extrapolated away."""
    V = 3.3e-3
    coarse, fine = (
        math.log(multiplier(FIG2, V, omega_dt, False)) / time_step(FIG2, omega_dt)
        for omega_dt in (0.02, 0.01)
    )
    growth = float(stability(FIG2, V).growth_rate)
    assert 2 * fine - coarse == pytest.approx(growth, rel=0.01)
    assert fine - growth == pytest.approx(0.5 * (coarse - growth), rel=0.02)


@pytest.mark.statistics
def test_the_cases_of_figure_3():
    rows = claims("slip", [claims_steps.on_map])
    assert tuple(row.id for row in rows) == CASES
    for row in rows:
        assert (row.converged, row.error, row.verdict) == ((156.0,), 0.0, "agrees")
    assert list(rows[0].scheme.values()) == [(154.0,), (156.0,)]


def test_every_case_is_counted_by_the_scheme(monkeypatch):
    """A case on the wrong side is found: with all speeds called stable, the unstable ones are."""
    monkeypatch.setattr(claims_steps, "FIG3_M", (1e4, 1e5, 2))
    monkeypatch.setattr(claims_steps, "FIG3_V_LP", (1e-3, 1e-1, 3))
    row = claims("slip", [claims_steps.on_map])[0]
    assert row.converged == (6.0,)
    assert row.verdict == "differs"  # 6 of what should be 156
    assert all(values == (6.0,) for values in row.scheme.values())


def claim(**values):
    given = {"id": "x", "where": "sec. 1", "claim": "A | B", "paper": "2.6 to 4", "unit": "mm/s"}
    return Claim(**given | {"converged": (2.6, 4.0), "error": 1e-3, "error_from": "e"} | values)


def test_verdict():
    covers = (to_digits(2.6, 0.1), to_digits(4, 1))
    assert covers == ((pytest.approx(2.55), pytest.approx(2.65)), (3.5, 4.5))
    by_scheme = {(0.1, 1e-4): (1.9, 4.8), (0.01, 1e-5): (2.61, 3.84)}
    assert claim(covers=covers).verdict == "agrees"
    assert claim().verdict == "no value given"
    off = claim(covers=covers, converged=(2.78, 3.65))
    assert off.verdict == "differs"
    both = claim(covers=covers, converged=(2.78, 3.65), scheme=by_scheme)
    assert both.verdict == "agrees with the scheme only"
    with pytest.raises(ValueError, match="zip"):
        claim(covers=covers[:1]).holds((2.6, 4.0))


def test_pair_tells_the_largest_difference():
    found = pair(lambda rtol: (1.0, 2.0 + (rtol > 1e-9)))
    assert found["converged"] == (1.0, 2.0)
    assert found["error"] == 1.0


def test_written_table(tmp_path):
    covers = ((2.55, 2.65), (3.5, math.inf))
    rows = [
        claim(covers=covers, scheme={(0.1, 1e-4, 2e-4): (1.9, 4.8)}),
        Claim(id="y", where="w", claim="c", paper="", unit="", note="Why.", **exact(156.0)),
    ]
    paths = claims_table.write(rows, "slip", tmp_path)
    assert [path.name for path in paths] == ["claims_slip.md", "claims_slip.json"]
    assert sorted(tmp_path.iterdir()) == sorted(paths)  # nothing half-written is left
    text = paths[0].read_text()
    assert "1 agrees; 1 no value given" in text
    assert r"A \| B" in text
    assert "1.9, 4.8 mm/s at omega dt = 0.1, dt = 100, 200 us" in text
    assert "2.6 to 4<br>taken as 2.55..2.65, > 3.5" in text
    assert "156 (closed form)" in text
    assert "Why." in text
    record = json.loads(paths[1].read_text())
    first, second = record["claims"]
    assert first["covers"] == [[2.55, 2.65], [3.5, None]]
    assert first["scheme"] == [{"omega_dt": 0.1, "dt": [1e-4, 2e-4], "values": [1.9, 4.8]}]
    assert first["verdict"] == "agrees"
    assert second["paper"] is None
    assert record["law"] == "slip"


def test_unknown_law():
    with pytest.raises(ParameterError, match="'sloth'"):
        claims("sloth")


@pytest.mark.parametrize("width", [80, 140])
def test_the_table_for_the_terminal_keeps_room_for_its_text(width):
    rows = [claim(scheme={(0.1, 1e-4, 2e-4): (1.9, 4.8)}, note="Why.")]
    console = Console(width=width)
    with console.capture() as text:
        console.print(claims_table.terminal(rows, "slip"))
    lines = text.get().splitlines()
    assert max(map(len, lines)) <= width
    claims_cell, values, _ = (len(part) for part in lines[1][1:-1].split("┳"))
    assert (claims_cell >= 30, values >= 35) == (True, True)
    for source in ("Paper: ", "Paper's scheme: 1.9, 4.8 mm/s", "Converged: "):
        assert any(source in line for line in lines)
    assert any("Why." in line for line in lines)
