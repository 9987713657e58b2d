"""Symbols of quantities as mathematics."""

import pytest
from matplotlib.mathtext import MathTextParser

import ratestate as rs


@pytest.mark.parametrize(
    ("symbol", "text"),
    [
        ("V_lp", "$V_{lp}$"),
        ("K_c", "$K_c$"),
        ("b2", "$b_{2}$"),
        ("Dc2", "$D_{c2}$"),
        ("mu_w", r"$\mu_w$"),
        ("theta2_start", r"$\theta_{2,start}$"),
        ("K_over_K_c_qs", "$K/K_{c,qs}$"),
        ("tau_by_V_lp", r"$\tau/V_{lp}$"),
        ("stress_drop", r"$\mathrm{stress~drop}$"),
        ("foo", r"$\mathrm{foo}$"),
    ],
)
def test_symbols_as_mathematics(symbol, text):
    assert rs.plot.label(symbol) == text


def test_matplotlib_can_set_the_labels_of_all_quantities():
    parser = MathTextParser("path")
    for symbol in rs.QUANTITIES:
        assert parser.parse(rs.plot.label(symbol)).width > 0.0
