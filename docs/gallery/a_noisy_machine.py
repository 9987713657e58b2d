"""
Uneven loading excites the block at its own frequency
=====================================================

The load-point speed fluctuates at random by 10 %. Its mean is just below the critical velocity, so
steady sliding is stable. The block responds most strongly at the frequency at which it would
vibrate above the critical velocity.
"""

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
rng = np.random.default_rng(4)
t = np.arange(0, 4, 2e-3)
V = 0.95 * slider.V_c * (1 + 0.1 * rng.uniform(-1, 1, t.size))
times = np.arange(0, t[-1], 1e-3)
run = rs.simulate(slider, rs.Loading.series(t, V), t[-1], times=times)

fig, axes = plt.subplots(1, 2)
shown = run.sel(time=slice(2.0, 2.6))
axes[0].plot(shown.time, shown.V_load * 1e3, color=plot.GRAY, lw=0.6, label="load point")
axes[0].plot(shown.time, shown.V * 1e3, color="k", lw=1.0, label="block")
axes[0].set(xlabel="Time [s]", ylabel="$V$ [mm/s]", ylim=(1.4, 5.4))
axes[0].legend(loc="upper right")
tau = (run.tau / slider.sigma).values[times.size // 4 :]
power = np.abs(np.fft.rfft((tau - tau.mean()) * np.hanning(tau.size)))
axes[1].plot(np.fft.rfftfreq(tau.size, 1e-3), power / power.max(), color="k", lw=0.8)
axes[1].axvline(float(rs.hopf(slider).frequency), color=plot.RED, ls="--", lw=1)
axes[1].text(52, 0.9, "Hopf frequency", color=plot.RED)
axes[1].set(xlim=(0, 120), xlabel="Frequency [Hz]", ylabel=r"Spectrum of $\tau/\sigma$")
plt.show()
