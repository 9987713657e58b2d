"""
A velocity step up and down, under both laws
============================================

The load point moves ten times faster, then as before. Friction rises at once (the direct effect,
``a``) and then falls over a slip of about ``Dc`` (the evolution effect, ``b``). Under the slip law
the step down mirrors the step up. Under the aging law the step down takes less slip, because
contacts strengthen with time.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

fig, ax = plt.subplots()
steps = rs.Loading.steps("1 um/s", ("40 s", "10 um/s"), ("60 s", "1 um/s"))
for law, color in (("slip", "k"), ("aging", plot.BLUE)):
    slider = rs.SpringSlider(a=0.010, b=0.015, Dc="10 um", sigma="5 MPa", K="100 GPa/m", law=law)
    run = rs.simulate(slider, steps, t_end=160)
    ax.plot(run.delta_lp * 1e6, run.mu, color=color, lw=1.2, label=f"{law} law")
ax.set(xlabel=r"Load-point displacement [$\mu$m]", ylabel=r"Friction $\mu$")
ax.legend()
plt.show()
