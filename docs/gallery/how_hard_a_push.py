"""
How hard stable sliding may be pushed
=====================================

Just below the critical velocity a slider is stable, but a step in speed that is large enough
throws it into its cycle. The closer to ``V_c``, the smaller a step will do; below the fold none
does.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray

import ratestate as rs
from ratestate import plot
from ratestate.dynamics import basin

slider = rs.SpringSlider(
    a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="606 MPa/m", law="aging"
)
shares = np.linspace(0.745, 0.99, 12)
V_lp = xarray.DataArray(shares * slider.V_c, dims="V_lp")
edge = basin.escape(slider, V_lp)

fig, axes = plt.subplots(1, 2)
axes[0].plot(shares, edge.step_up, "ko-", ms=3.5)
axes[0].set(xlabel="$V_{lp}/V_c$", ylabel="Smallest step up, $V_{new}/V_{old}$", ylim=(1, None))
axes[1].plot(shares, edge.amplitude, "o-", ms=3.5, color=plot.BLUE, label="the cycle beyond")
axes[1].plot(shares, edge.unstable_amplitude, "o--", ms=3.5, color=plot.BLUE, label="the fence")
axes[1].set(xlabel="$V_{lp}/V_c$", ylabel=plot.AMPLITUDE)
axes[1].legend(loc="lower left")
plt.show()
