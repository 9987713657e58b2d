"""
From stick-slip to vibration as loading gets faster
===================================================

Two periods of the limit cycle at each of four loading speeds (the slider of Fig. 4 of Im, Marone &
Elsworth 2019). As loading gets faster, the stress drops first become smaller. Then inertia turns
them into a vibration, in which the spring stress (black) and friction (red) differ.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(
    a=0.005, b=0.008, Dc="10 um", mu0=0.6, V0=1e-9, sigma="4 MPa", M=100, K="960 MPa/m"
)
fig, axes = plt.subplots(2, 2, figsize=(7.2, 4.4))
for ax, V in zip(axes.flat, (1e-4, 1e-2, 5e-2, 0.5), strict=True):
    cycle = rs.limit_cycle(slider, V)
    period = float(cycle.period)
    run = rs.simulate(slider, V, 40 * period, V_start=V / 10)
    last = run.sel(time=slice(38 * period, None))
    plot.trace(last.assign_coords(time=last.time - last.time[0]), ax)
    name = rs.classify(cycle).regime.item()
    ax.set_title(f"{1e3 * V:g} mm/s: {name}, {float(cycle.frequency):.3g} Hz")
axes[0, 0].set_ylim(0.52, 0.595)
axes[0, 0].legend(loc="upper left")
plt.show()
