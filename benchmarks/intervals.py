"""How often intervals of fits hold the truth: `python benchmarks/intervals.py [NUMBER]`.

Of 200 records drawn over a realistic range, which takes a minute: README has the numbers.  With
--two-states of as many records under laws with two states.
"""

import argparse
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray
from report import CONSOLE, Table
from scipy.stats import binom, chi2

import ratestate as rs
from ratestate.records.fitting.unknowns import to_coordinate

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from synthetic_records import FREE, record

FREE_OF_TWO_STATES = ("a", "b", "Dc", "b2", "Dc2", "K")


class Drawn(NamedTuple):
    """A record drawn from a realistic range, its truth, and from where a search may begin."""

    truth: rs.SpringSlider
    start: rs.SpringSlider
    data: xarray.Dataset
    is_red: bool


def drawn(seed):
    """A velocity step up or down, either law, with inertia in every second, noise of either kind.

    Ranges: a 0.003 to 0.016, b/a 0.5 to 1.6, Dc 1 to 100 um, sigma 2 to 50 MPa, K 1.8 to 16 K_c
    (of what is unstable), V 0.1 to 200 um/s, steps by 2.5 to 20, noise 1 to 6 % of the direct
    effect.  eta at the larger speed is 0.1 to 10 where there is mass.
    """
    rng = np.random.default_rng(1000 + seed)
    a, sigma, Dc = 10 ** rng.uniform((-2.5, 6.3, -6), (-1.8, 7.7, -4))
    b = a * rng.uniform(0.5, 1.6)
    V1 = 10 ** rng.uniform(-7, -5)
    V2 = V1 * 10 ** (rng.choice([-1, 1]) * rng.uniform(0.4, 1.3))
    K_c = max(b - a, 0.15 * a) * sigma / Dc
    eta = 10 ** rng.uniform(-1, 1) if seed % 4 > 1 else 0.0
    K = K_c * (1 + eta) * 10 ** rng.uniform(0.25, 1.2 if eta == 0.0 else 0.6)
    M = eta * a * sigma * Dc / max(V1, V2) ** 2
    law = ("slip", "aging")[seed % 2]
    truth = rs.SpringSlider(a=a, b=b, Dc=Dc, sigma=sigma, K=K, M=M, V0=V1, law=law)
    distance = Dc * rng.uniform(15, 40)
    step, end = 0.5 * distance / V1, 0.5 * distance / V1 + distance / V2
    before, after = rng.integers(150, 500), rng.integers(600, 2000)
    early = np.linspace(0, step, before, endpoint=False)
    t = np.concatenate([early, np.linspace(step, end, after)])
    level = a * abs(np.log(V2 / V1)) * 10 ** rng.uniform(-2.0, -1.2)
    is_red = bool(rng.random() < 0.5)
    share = rng.uniform(0.3, 1.0) if is_red else 0.0
    time = (end - step) / after * 10 ** rng.uniform(0.3, 1.5)
    noise = {"noise": level * np.sqrt(1 - share), "red": level * np.sqrt(share), "time": time}
    data = record(truth, rs.Loading.steps(V1, (step, V2)), t, seed=seed, **noise)
    factors = 2.0 ** rng.normal(size=4)
    start = {s: f * getattr(truth, s) for s, f in zip(("a", "b", "Dc", "K"), factors, strict=True)}
    return Drawn(truth, truth.replace(**start), data, is_red)


def drawn_of_two_states(seed):
    """The same of a law with two states, without mass; the second state over the longer distance.

    Ranges: b/a 0.4 to 1.2, b2/a 0.15 to 0.6 of either sign, Dc 1 to 20 um, Dc2 8 to 25 Dc, K 2 to
    16 K_c (of what is unstable), slip of 8 to 16 Dc2 after the step, and else those of `drawn`.
    """
    rng = np.random.default_rng(5000 + seed)
    a, sigma, Dc = 10 ** rng.uniform((-2.5, 6.3, -6), (-1.8, 7.7, -4.7))
    b, b2 = a * rng.uniform(0.4, 1.2), a * rng.uniform(0.15, 0.6) * rng.choice([-1, 1, 1])
    Dc2 = Dc * rng.uniform(8, 25)
    V1 = 10 ** rng.uniform(-7, -5)
    V2 = V1 * 10 ** (rng.choice([-1, 1]) * rng.uniform(0.4, 1.3))
    law = ("two-state-slip", "two-state-aging")[seed % 2]
    soft = rs.SpringSlider(a=a, b=b, Dc=Dc, b2=b2, Dc2=Dc2, sigma=sigma, K=1.0, V0=V1, law=law)
    K = max(soft.K_c_qs, 0.15 * a * sigma / Dc) * 10 ** rng.uniform(0.3, 1.2)
    truth = soft.replace(K=K)
    distance = Dc2 * rng.uniform(8, 16)
    step, end = 3.0 * Dc2 / V1, 3.0 * Dc2 / V1 + distance / V2
    early = np.linspace(0, step, rng.integers(150, 500), endpoint=False)
    t = np.concatenate([early, np.linspace(step, end, rng.integers(1500, 3000))])
    level = a * abs(np.log(V2 / V1)) * 10 ** rng.uniform(-2.0, -1.2)
    is_red = bool(rng.random() < 0.5)
    share = rng.uniform(0.3, 1.0) if is_red else 0.0
    time = (end - step) / t.size * 10 ** rng.uniform(0.3, 1.5)
    noise = {"noise": level * np.sqrt(1 - share), "red": level * np.sqrt(share), "time": time}
    data = record(truth, rs.Loading.steps(V1, (step, V2)), t, seed=seed, **noise)
    factors = zip(FREE_OF_TWO_STATES, 2.0 ** rng.normal(size=6), strict=True)
    start = {symbol: factor * getattr(truth, symbol) for symbol, factor in factors}
    start["Dc"], start["Dc2"] = sorted((start["Dc"], start["Dc2"]))
    return Drawn(truth, truth.replace(**start), data, is_red)


class Coverage(NamedTuple):
    """What the fits of n records that were drawn say of the truth."""

    holds: np.ndarray  # (n, parameters, levels) bool, whether the interval holds it
    together: np.ndarray  # (n,) bool, whether the 95 % region of all parameters but K holds it
    errors: np.ndarray  # (n, parameters) of the estimates, in the fit's coordinates
    is_red: np.ndarray  # (n,) bool
    has_mass: np.ndarray  # (n,) bool


def coverage(number, draw=drawn, free=FREE):
    """Fit the first records drawn, so many, each from where a search may begin; `Coverage`."""
    names, rows = list(free), []
    for seed in range(number):
        case = draw(seed)
        result = rs.fit(case.data, case.start, free)
        truth = np.array([getattr(case.truth, name) for name in names])
        estimates = np.array([float(result[name]) for name in names])
        low, high = np.moveaxis(result.interval.sel(parameter=names).values, -1, 0)
        holds = (low <= truth[:, None]) & (truth[:, None] <= high)
        error = np.array(
            [
                to_coordinate(name, estimate) - to_coordinate(name, true)
                for name, estimate, true in zip(names, estimates, truth, strict=True)
            ]
        )
        together = _likely_together(case, result, free)
        rows.append((holds, together, error, case.is_red, case.truth.M > 0))
    return Coverage(*map(np.array, zip(*rows, strict=True)))


def _likely_together(case, result, free):
    """Whether a likelihood-ratio test accepts the truth of all free parameters but K at once."""
    white, red = float(result.noise_white), float(result.noise_red)
    noise = {"white": white, "red": red, "time": float(result.noise_time)} if red else white
    if float(result.noise_exponent):  # such a noise cannot be given; it is estimated again
        noise = None
    start = "free" if "V_start" in result else "steady"
    settings = {"noise": noise, "start": start, "errors": "covariance"}
    held = rs.fit(case.data, case.truth, ("K",), **settings)
    deviance = 2.0 * float(result.log_likelihood - held.log_likelihood)
    return deviance < chi2.ppf(0.95, len(free) - 1)


def rows(found, free):
    """(what, part that 68 % intervals hold, part that 95 % intervals hold, number) of each kind."""
    kinds = {"all": found.holds, "white noise": found.holds[~found.is_red]}
    kinds["correlated noise"] = found.holds[found.is_red]
    kinds["with mass"] = found.holds[found.has_mass]
    kinds["without mass"] = found.holds[~found.has_mass]
    kinds |= {name: found.holds[:, [i]] for i, name in enumerate(free)}
    sizes = {what: holds[..., 0].size for what, holds in kinds.items()}
    return [(w, *holds.mean(axis=(0, 1)), sizes[w]) for w, holds in kinds.items() if sizes[w]]


def main():
    parser = argparse.ArgumentParser(description="Coverage of the intervals of fits.")
    parser.add_argument("number", nargs="?", type=int, default=200, help="records")
    parser.add_argument("--two-states", action="store_true", help="under laws with two states")
    options = parser.parse_args()
    draw, free = drawn_of_two_states, FREE_OF_TWO_STATES
    if not options.two_states:
        draw, free = drawn, FREE
    number = options.number
    warnings.simplefilter("ignore", rs.FitWarning)
    found = coverage(number, draw, free)
    table = Table("", "68 %", "95 %", "intervals", title=f"Truth in the intervals of {number} fits")
    for what, *parts, size in rows(found, free):
        table.add_row(what, *(f"{100 * part:.1f} %" for part in parts), str(size))
    CONSOLE.print(table)
    low, high = binom.interval(0.95, number, 0.95)
    every = int(found.holds[..., -1].all(axis=1).sum())
    CONSOLE.print(
        f"of {number} records a likelihood-ratio test at 95 % accepts the truth of all parameters "
        f"but K at once in {int(found.together.sum())}, and every single 95 % interval holds it in "
        f"{every}; of one interval or test {low:.0f} to {high:.0f} are expected, 95 times of 100"
    )


if __name__ == "__main__":
    main()
