"""
Peak friction grows with hold time
==================================

Peak friction after holds of 1 s to 100,000 s. Under the aging law it grows by ``b ln 10`` per
decade of hold time. Under the slip law it grows more slowly, because the state changes only with
slip.
"""

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(a=0.008, b=0.010, Dc="10 um", sigma="10 MPa", K="50 GPa/m")
holds = np.geomspace(1, 1e5, 21)
fig, ax = plt.subplots()
for law, color in (("slip", "k"), ("aging", plot.BLUE)):
    peaks = []
    for hold in holds:
        loading = rs.Loading.steps("10 um/s", (1.0, 0.0), (1.0 + hold, "10 um/s"))
        run = rs.simulate(slider.replace(law=law), loading, t_end=21.0 + hold)
        peaks.append(float(run.mu.max() - run.mu[0]))
    ax.semilogx(holds, peaks, "o-", color=color, ms=3.5, lw=1, label=f"{law} law")
ax.semilogx(holds, slider.b * np.log(holds / 2.0), "--", color=plot.GRAY, lw=1, label=r"slope $b$")
ax.set(xlabel="Hold [s]", ylabel=r"Peak $-$ steady $\mu$", ylim=(0, None))
ax.legend()
plt.show()
