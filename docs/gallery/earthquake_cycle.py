"""
An earthquake cycle, from plate rate to metres per second
=========================================================

A fault loaded at 3 cm a year slips in earthquakes, decades apart, that last seconds. In a
quasi-dynamic model the radiated waves slow it down: ``damping`` is ``G/(2 c_s)``, 4.6 MPa s/m for
G = 32 GPa and a shear-wave speed of 3.5 km/s, and the mass is 0. A block with mass and no damping
overshoots instead: its stress drop and the time to the next earthquake are twice as large. Its
speed spans 20 decades; with damping, 14.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

year = 365.25 * 86400
V_lp = 0.03 / year
fault = rs.SpringSlider(a=0.010, b=0.015, Dc="1 cm", sigma="50 MPa", K="10 MPa/m", law="aging")
fig, (cycle, event) = plt.subplots(
    1, 2, figsize=(7.2, 3.0), layout="constrained", sharey=True, width_ratios=[1.3, 1]
)
sliders = {
    "radiation damping": fault.replace(damping="4.6 MPa s/m"),
    r"mass, $10^6$ kg/m$^2$": fault.replace(M=1e6),
}
for (name, slider), color in zip(sliders.items(), (plot.RED, "k"), strict=True):
    period = float(rs.limit_cycle(slider, V_lp).period)
    run = rs.simulate(slider, V_lp, 3 * period, V_start=0.5 * V_lp)
    t, V = run.time.values, run.V.values
    first = t[(V > 0.1) & (t > 0.8 * period)][0]
    shown = (t > first - 0.2 * period) & (t < first + 1.3 * period)
    cycle.semilogy((t[shown] - first) / year, V[shown], color=color, lw=1.2)
    near = (t > first - 10.0) & (t < first + 20.0)
    event.plot(t[near] - first, V[near], color=color, lw=1.2, label=name)
cycle.axhline(V_lp, color=plot.GRAY, lw=0.8, ls=":")
cycle.set(xlabel="Years from an earthquake", ylabel=r"$V$ [m/s]")
event.set(xlabel="Seconds from $V$ = 0.1 m/s")
event.legend(loc="lower left")
plt.show()
