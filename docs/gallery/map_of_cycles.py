"""
Amplitude of 10,000 limit cycles over mass and speed
====================================================

The plane of Fig. 3 of Im, Marone & Elsworth (2019), with a limit cycle computed for each of 10,000
points. White is steady sliding. The line is the critical velocity of eq. 10.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m")
M, V_lp = rs.logspace("M", 1e2, 1e5, 100), rs.logspace("V_lp", 10**-3.8, 1e-1, 100)
cycles = rs.limit_cycle(slider.replace(M=M), V_lp, rtol=1e-4)

fig, ax = plt.subplots(figsize=(7.2, 3.8))
colors = ax.pcolormesh(
    V_lp, M, cycles.amplitude.where(cycles.amplitude > 0), norm="log", cmap="viridis"
)
ax.plot(slider.replace(M=M).V_c, M, color=plot.RED, lw=1.5, label="$V_c$ (eq. 10)")
ax.set(xscale="log", yscale="log", xlim=(10**-3.8, 0.1))
ax.set(xlabel="Loading velocity [m/s]", ylabel="Mass per area [kg/m$^2$]")
ax.legend(loc="lower left")
fig.colorbar(colors, label=plot.AMPLITUDE)
plt.show()
