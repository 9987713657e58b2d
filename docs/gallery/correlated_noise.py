"""
Assuming white noise makes error estimates too small
====================================================

One hundred records of the same velocity step, fitted one by one: each dot is an estimate. Half of
the noise is white, half is correlated over a second. The dashed ellipse would contain 95 % of the
dots if the noise were white. The solid one uses the errors of ``fit``, which estimates the
correlation.
"""

import warnings

import matplotlib.pyplot as plt
import numpy as np

import ratestate as rs
from ratestate import plot

RECORDS, NOISE, TIME = 100, 2e-4, 1.0
PAIRS = (("a", 1e3, "$a$ [$10^{-3}$]"), ("Dc", 1e6, r"$D_c$ [$\mu$m]"))
slider = rs.SpringSlider(
    a=0.010, b=0.013, Dc="12 um", sigma="10 MPa", K="15 GPa/m", V0="3 um/s", law="aging"
)
t = np.arange(0.0, 80.0, 0.05)
run = rs.simulate(slider, rs.Loading.steps("3 um/s", (40.0, "10 um/s")), t[-1], times=t)
clean = run[["delta_lp"]].assign(friction=run.tau / slider.sigma)
rng = np.random.default_rng(5)


def noise():
    """White noise plus noise of the same size that is correlated over TIME."""
    white, red = rng.normal(0.0, NOISE, (2, t.size))
    keep = np.exp(-(t[1] - t[0]) / TIME)
    for i in range(1, t.size):
        red[i] = keep * red[i - 1] + np.sqrt(1.0 - keep**2) * red[i]
    return white + red


def covariance(result, names):
    """Covariance of two parameters, in SI."""
    error = result.standard_error.sel(parameter=names).values
    return result.correlation.sel(parameter=names, other=names).values * np.outer(error, error)


names = [name for name, _, _ in PAIRS]
scale = np.array([factor for _, factor, _ in PAIRS])
dots, by_white, by_fit = [], [], []
warnings.simplefilter("ignore", rs.FitWarning)  # of fits that assume white noise
for i in range(RECORDS):
    record = clean.assign(friction=clean.friction + noise())
    result = rs.fit(record, slider, start="steady", errors="covariance")
    dots.append([float(result[name]) for name in names])
    by_fit.append(covariance(result, names))
    if i < 6:  # enough for a mean: white noise always gives nearly the same errors
        white = rs.fit(record, slider, errors="covariance", noise=float(result.rms))
        by_white.append(covariance(white, names))

fig, ax = plt.subplots(figsize=(7.2, 3.6))
dots = np.array(dots) * scale
ax.plot(*dots.T, ".", ms=4, mew=0, color="0.55")
around = np.array([np.cos(angle := np.linspace(0, 2 * np.pi, 200)), np.sin(angle)])
true = np.array([getattr(slider, name) for name in names]) * scale
for spread, look in ((by_white, "--"), (by_fit, "-")):
    spread = np.mean(spread, axis=0) * np.outer(scale, scale)
    away = np.einsum("ni,ij,nj->n", dots - true, np.linalg.inv(spread), dots - true)
    inside = np.mean(away < 5.991)  # 95 % of chi-square of two degrees of freedom
    words = "white noise" if look == "--" else "correlated noise"
    words += f": contains {100 * inside:.0f} %"
    ellipse = true[:, None] + np.sqrt(5.991) * np.linalg.cholesky(spread) @ around
    ax.plot(*ellipse, look, lw=1.2, color=plot.RED if look == "--" else "k", label=words)
ax.plot(*true, "k+", ms=9)
ax.set(xlabel=PAIRS[0][2], ylabel=PAIRS[1][2])
title = {"title": "95 % ellipse, assuming", "alignment": "left"}
ax.legend(loc="center left", bbox_to_anchor=(1.02, 0.5), **title)
plt.show()
