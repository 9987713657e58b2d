"""
What shakes a sliding block
===========================

A small oscillation of the drive, or of the load that presses the surfaces together, makes friction
and speed oscillate too. :func:`ratestate.frequency_response` gives the amplitude at each
frequency. Near the critical stiffness the block rings: the peak grows and narrows as ``K`` comes
down to ``K_c``, at the frequency of the Hopf bifurcation (dotted). Normal stress moves the block
far more than the drive does. At 1.2 ``K_c``, if normal stress oscillates by 0.1 %, the speed
oscillates by 80 %.
"""

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs
from ratestate import plot

V_lp = "1 mm/s"
slider = rs.SpringSlider(
    a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="1 GPa/m", M=3000, alpha=0.2
)
K_c = slider.K_c(V_lp)
frequency = np.geomspace(0.5, 500, 600)
fig, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.0), layout="constrained", sharex=True)
for ratio, color in ((1.02, plot.RED), (1.2, "k"), (3.0, plot.BLUE)):
    near = slider.replace(K=ratio * K_c)
    response = rs.frequency_response(near, V_lp, frequency)
    look = {"color": color, "lw": 1.2, "label": f"$K$ = {ratio:g} $K_c$"}
    left.loglog(frequency, response.V_by_V_lp_gain, **look)
    right.loglog(frequency, response.tau_by_sigma_gain, **look)
for ax in (left, right):
    ax.axvline(float(rs.hopf(slider, V_lp).frequency), color=plot.GRAY, lw=0.8, ls=":")
    ax.set(xlabel="Frequency [Hz]", xlim=(0.5, 500))
left.set(title="speed, per load-point speed", ylabel=r"$|\Delta V|/|\Delta V_{lp}|$")
right.set(title="shear stress, per normal stress", ylabel=r"$|\Delta\tau|/|\Delta\sigma|$")
left.legend()
plt.show()
