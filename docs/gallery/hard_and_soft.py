"""
Vibration starts gradually or with a jump
=========================================

Amplitude of limit cycles against loading speed for three springs, aging law. For the softest
spring the branch turns back at a fold, and vibration starts with a jump. The dashed part is
unstable, so experiments do not show it.
"""

import matplotlib.pyplot as plt

import ratestate as rs
from ratestate import plot

slider = rs.SpringSlider(
    a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m", law="aging"
)
fig, axes = plt.subplots(1, 3, sharey=True)
for ax, ratio in zip(axes, (1.01, 1.05, 1.5), strict=True):
    spring = slider.replace(K=ratio * slider.K_c_qs)
    branch = rs.continue_cycle(spring, "V_lp", 2 * spring.V_c, 0.5 * spring.V_c, rtol=1e-6)
    plot.branch(branch, ax)
    ax.set(xscale="linear", xlabel="$V_{lp}$ [mm/s]", ylabel="")
    ax.set_title(f"$K = {ratio}\\,K_{{c,qs}}$")
    ax.xaxis.set_major_formatter(lambda V, _: f"{1e3 * V:g}")
    ax.get_legend().remove()
axes[0].set_ylabel(plot.AMPLITUDE)
plt.show()
