"""
Period doubling and chaos with two states
=========================================

Without mass, a slider with a single state comes to steady sliding or runs away. With two states it
has limit cycles below the critical stiffness. On softer springs their period doubles again and
again, until the motion never repeats (Ruina 1983; Gu et al. 1984). The parameters are theirs:
``b = a``, ``b2 = 0.84 a``, and distances in the ratio 0.048.

Left: the stress maxima of a long run, for each stiffness. Below 0.8517 times the critical
stiffness the slider runs away. Dashed lines show where the period doubles. The distance between
these lines shrinks by a factor of 5.6 and then of 4.8. After many doublings the factor is expected
to be 4.669 (Feigenbaum's constant). Right: each maximum against the one before, at 0.853 times the
critical stiffness. The points lie on a curve with a single extremum, like the logistic map. Two
motions that start close together move apart. The Lyapunov exponent is the mean growth of the
logarithm of their distance from one maximum to the next.
"""

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import ratestate as rs
from ratestate import plot

V_lp, start = 1e-6, {"V_start": "0.77 um/s"}  # from V_lp/10, the usual start, it runs away
given = {"a": 0.01, "b": 0.01, "b2": 0.0084, "Dc": "4.8 um", "Dc2": "100 um", "sigma": "5 MPa"}
slider = rs.SpringSlider(**given, K="800 MPa/m", law="two-state-slip")
K_c = slider.K_c(V_lp)
period = 2 * np.pi / float(rs.stability(slider, V_lp).omega_c)  # of the smallest cycles


def softer(ratios):
    """Sliders with springs of these stiffnesses over K_c."""
    return slider.replace(K=K_c * xr.DataArray(ratios, dims="K"))


def maxima(ratios, periods, kept):
    """Stress maxima (tau/sigma) of the last periods of a run, an array for each stiffness."""
    sliders, t = softer(ratios), period * np.linspace(periods - kept, periods, 60 * kept)
    run = rs.simulate(sliders, V_lp, t[-1], times=t, rtol=1e-6, **start)
    slower = V_lp - run.V.values  # stress rises by K times this, and has its maximum where it is 0
    before, after = slower[:, :-1], slower[:, 1:]
    risen = 0.5 * before**2 / (before - after) * np.diff(t) * sliders.K.values[:, None]
    tops = (run.tau.values[:, :-1] + risen) / slider.sigma
    return [top[is_top] for top, is_top in zip(tops, (before > 0) & (after <= 0), strict=True)]


ratios = np.append(np.linspace(0.8517, 0.857, 160), np.linspace(0.8571, 0.87, 130))
points = maxima(ratios, periods=400, kept=40)

doublings = []
spans = {1: (0.8665, 0.869), 2: (0.8571, 0.8578), 4: (0.8554, 0.8557), 8: (0.85506, 0.8551)}
for returns, span in spans.items():
    near = np.linspace(*span, 4)
    cycles = rs.limit_cycle(softer(near), V_lp, **start)
    assert (cycles.returns == returns).all()
    multiplier = cycles.multipliers[:, 0].values.real
    doublings.append(np.polyval(np.polyfit(multiplier, near, 2), -1.0))

(chaos,) = maxima([0.853], periods=800, kept=600)
x, y = chaos[:-1], chaos[1:]

speeds = xr.DataArray(np.linspace(0.75e-6, 0.8e-6, 200), dims="start")
pairs = speeds * xr.DataArray([1.0, 1.0 + 1e-9], dims="pair")
t, one = period * np.arange(15.0, 45.0, 0.2), slider.replace(K=0.853 * K_c)
runs = rs.simulate(one, V_lp, t[-1], V_start=pairs, times=t, rtol=1e-11)
apart = np.log(np.abs(runs.tau.diff("pair"))).mean(["start", "pair"])
exponent = np.polyfit(t, apart, 1)[0] * 600 * period / len(chaos)

fig, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), width_ratios=(2, 1), layout="constrained")
for ratio, top in zip(ratios, points, strict=True):
    left.plot(np.full(len(top), ratio), top, ".", color="k", ms=1.5, mew=0)
for ratio in doublings:
    left.axvline(ratio, color=plot.BLUE, ls="--", lw=0.8)
left.set(xlabel="Stiffness $K/K_c$", ylabel=r"Stress maxima $\tau/\sigma$", xlim=(0.8512, 0.87))
right.plot(x, y, ".", color="k", ms=2)
right.plot([x.min(), x.max()], [x.min(), x.max()], color=plot.BLUE, lw=0.8)
right.set(xlabel="One maximum", ylabel="The next")
right.text(0.06, 0.08, f"Lyapunov exponent\n{exponent:.1f} per maximum", transform=right.transAxes)
plt.show()
