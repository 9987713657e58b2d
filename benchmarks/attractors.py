"""Where `limit_cycle` and a long `simulate` lead, on random sliders.

Half of them are anywhere in b/a 1.01 to 50, eta 1e-9 to 1e4, both laws; half where cycles double,
canards explode and cycles coexist with steady sliding.  The run is as long as the multiplier of the
cycle, or the decay of steady sliding, says that it needs to come within 1e-4; of those that need
more than the most cycles asked for, or close after more returns than `simulate` recognises, only
their number is told.
"""

import argparse

import numpy as np
import xarray as xr

import ratestate as rs

V_LP, A, SIGMA, DC = 1e-3, 0.005, 4e6, 1e-5
NEAR = 1e-4  # what may be left of the distance from the attractor
SAME = 1e-3  # of amplitude and frequency, relative
MOST_RETURNS = 8  # that `simulate` recognises as a period
LONGER = 1.0, 4.0, 64.0  # runs where the first disagrees


def draw(n, rng, law):
    """`SpringSlider` of n random sliders, in the dimension case."""
    anywhere = np.arange(n) % 2 == 0
    beta = np.where(
        anywhere, 1.0 + 10 ** rng.uniform(-2, np.log10(49), n), 10 ** rng.uniform(0.5, 1.69, n)
    )
    eta = np.where(anywhere, 10 ** rng.uniform(-9, 4, n), 10 ** rng.uniform(-7, 2, n))
    below, close = rng.uniform(0.02, 1.0, n), 10 ** rng.uniform(-5, -1.3, n)
    soft, doubling = 10 ** rng.uniform(-3, 0, n), rng.uniform(0.9, 1.4, n) / (1.0 + eta)
    of_K_c = np.choose(
        rng.integers(0, 5, n), [below, 1.0 - close, 1.0 + close, soft, np.minimum(doubling, 1.02)]
    )
    beta, eta, of_K_c = (xr.DataArray(values, dims="case") for values in (beta, eta, of_K_c))
    return rs.SpringSlider(
        a=A,
        b=A * beta,
        Dc=DC,
        sigma=SIGMA,
        K=of_K_c * (1.0 + eta) * (beta - 1.0) * A * SIGMA / DC,
        M=eta * A * SIGMA * DC / V_LP**2,
        law=law,
    )


def compare(slider, most):
    """Counts of how the answers compare, and the cases that contradict each other."""
    found = rs.limit_cycle(slider, V_LP)
    steady, cycle = (found.status == 1).values, (found.status == 0).values
    linear = rs.stability(slider, V_LP)
    size = np.abs(found.multipliers.values[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = np.where(cycle, np.log(NEAR) / np.log(size), 0.0) + 40.0
        rest = 2.0 * np.log(NEAR) / linear.growth_rate.values
        one_return = np.where(
            cycle, (found.period / found.returns).values, 2.0 * np.pi / linear.omega.values
        )
    length = np.where(cycle, needed * found.period.values, rest)
    told = (steady | cycle) & (length < most * one_return) & (found.returns.values <= MOST_RETURNS)
    off = np.flatnonzero(told)
    for longer in LONGER:  # a run may be slow where cycles have just ceased to be, or far away
        if len(off):
            part, at = slider_at(slider, off), found.isel(case=off)
            off = off[differs(part, at, longer * length[off])]
    counts = {
        "sliders": len(told),
        "cycles": int(cycle.sum()),
        "of several returns": int((found.returns.values[cycle] > 1).sum()),
        "steady sliding": int(steady.sum()),
        "refused": int((~steady & ~cycle).sum()),
        "not to be compared": int((~told & (steady | cycle)).sum()),
        "compared": int(told.sum()),
        "contradictions": len(off),
    }
    return counts, off, found


def differs(slider, found, length):
    """Whether runs of such lengths [s] end elsewhere than found; (n,) bool."""
    t_end = xr.DataArray(length, dims="case")
    run = rs.simulate(slider, rs.Loading.constant(V_LP), t_end, V_start=V_LP / 10, rtol=1e-9)
    with np.errstate(divide="ignore", invalid="ignore"):
        amplitude = np.abs(run.amplitude / found.amplitude - 1.0)
        pace = np.abs(run.returns / run.frequency * found.frequency / found.returns - 1.0)
    elsewhere = (amplitude > SAME) | (pace > SAME) | (run.status != 0)
    return xr.where(found.status == 1, run.amplitude > SAME * A, elsewhere).values


def slider_at(slider, which):
    """The sliders with these numbers."""
    values = {
        symbol: value.isel(case=which) if isinstance(value, xr.DataArray) else value
        for symbol, value in slider.parameters.items()
    }
    return rs.SpringSlider(**values)


def main():
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--count", type=int, default=20_000)
    options.add_argument("--seed", type=int, default=13)
    options.add_argument("--most", type=float, default=2000.0, help="cycles of a run")
    asked = options.parse_args()
    rng = np.random.default_rng(asked.seed)
    for law in ("slip", "aging"):
        slider = draw(asked.count // 2, rng, law)
        counts, off, found = compare(slider, asked.most)
        print(law, ", ".join(f"{name} {number:,}" for name, number in counts.items()))
        for i in off[:20]:
            one = slider_at(slider, [i])
            print(
                f"  K = {float(one.K[0])!r}, b = {float(one.b[0])!r}, M = {float(one.M[0])!r}: "
                f"status {int(found.status[i])}, {int(found.returns[i])} returns, "
                f"amplitude {float(found.amplitude[i]):.9g}, "
                f"multiplier {found.multipliers[i, 0].item():.9g}"
            )


if __name__ == "__main__":
    main()
