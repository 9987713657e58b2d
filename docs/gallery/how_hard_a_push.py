"""
How large a velocity step ends stable sliding
=============================================

Just below the critical velocity steady sliding is stable, but a large enough step in speed starts
a vibration. Left, the smallest such step: the closer to ``V_c``, the smaller. Right, the
amplitudes of the vibration and of the unstable cycle that separates it from steady sliding.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(
    a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="606 MPa/m", law="aging"
)
shares = np.linspace(0.745, 0.99, 8)
V_lp = xarray.DataArray(shares * slider.V_c, dims="V_lp")
edge = rs.escape(slider, V_lp)

fig, axes = plt.subplots(1, 2)
axes[0].plot(shares, edge.step_up, "ko-", ms=3.5)
axes[0].set(xlabel="$V_{lp}/V_c$", ylabel="Critical step, $V_{new}/V_{old}$", ylim=(1, None))
axes[1].plot(shares, edge.amplitude, "o-", ms=3.5, color=plot.BLUE, label="stable cycle")
axes[1].plot(
    shares, edge.unstable_amplitude, "o--", ms=3.5, color=plot.BLUE, label="unstable cycle"
)
axes[1].set(xlabel="$V_{lp}/V_c$", ylabel=plot.AMPLITUDE)
axes[1].legend(loc="lower left")
plt.show()
