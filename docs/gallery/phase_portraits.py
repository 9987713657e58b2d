"""
Limit cycles in the phase plane, from slow to fast loading
==========================================================

Slip velocity against stress over one period, at six loading speeds (the slider of Fig. 4 of Im,
Marone & Elsworth 2019). Under slow loading the block creeps over decades of speed, then slips
suddenly. Under fast loading it moves like an oscillator that almost stops once per period.
"""

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs

slider = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", mu0=0.6, V0=1e-9, sigma="4 MPa", M=100, K="960 MPa/m"
)
fig, ax = plt.subplots(figsize=(7.2, 4.2))
for V, color in zip(np.geomspace(1e-5, 1, 6), plt.cm.viridis(np.linspace(0, 0.9, 6)), strict=True):
    cycle = rs.orbit(slider, V)
    ax.semilogy(cycle.tau / slider.sigma, cycle.V / V, color=color, lw=1.2, label=f"{V:g} m/s")
ax.set(xlabel=r"$\tau/\sigma$", ylabel="$V/V_{lp}$")
ax.legend(title="$V_{lp}$")
plt.show()
