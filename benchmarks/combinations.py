"""Random runs of all that a slider may be made of, against SciPy: `python combinations.py [--n N]`.

Each has a law, a form of friction that goes with it, damping or none, mass or none, and a normal
stress that is constant, steps, goes up or down a ramp, or oscillates, with alpha or without.  The
oracle is SciPy's Radau at 1e-10 on the textbook forms of the tests (tests/helpers/textbook.py), in
V and theta, which share no code with the package.  500 runs take 40 minutes of one core.

Where an error is beyond 100 rtol, the motion itself is told: by how much it magnifies a change of
its start.
"""

import argparse
import math
import sys
import warnings
from pathlib import Path

import numpy as np

import ratestate as rs
from ratestate.friction.composition import takes_forms
from ratestate.friction.forms import FORMS
from ratestate.friction.law_formula import LOG
from ratestate.friction.laws import LAWS

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from textbook import OF_LAW, Reversing, Textbook, drawn

Textbook.method, Textbook.tolerance = "Radau", 1e-10

RTOL, POINTS = 1e-6, 11
# A run without mass is compared up to this part of the time to its instability.
BEFORE_RUNAWAY = 0.98


class Case:
    """A slider with all that was drawn for it, and its textbook."""

    def __init__(self, rng):
        self.law = str(rng.choice(list(OF_LAW)))
        law = LAWS[self.law]
        free = law.form == LOG and takes_forms(law)
        self.form = str(rng.choice([LOG, *FORMS])) if free else law.form
        p, V = drawn(self.law, rng)
        p["M"] *= float(rng.random() < 0.7)
        p["damping"] = float(rng.choice([0.0, p["a"] * p["sigma"] / V])) * 10 ** rng.uniform(
            -3, 0.5
        )
        p["alpha"] = float(rng.choice([0.0, rng.uniform(0.0, 0.5)]))
        own = {"friction_form": self.form} if self.form != law.form else {}
        if self.form == "cut-off":
            own |= {"V1": V * 10 ** rng.uniform(1, 4), "V2": V * 10 ** rng.uniform(0, 3)}
        self.p, self.own, self.V, self.unit = p, own, V, p["Dc"] / V
        self.t_end = 10.0 * self.unit
        self._draw_normal_stress(rng)

    def _draw_normal_stress(self, rng):
        unit, V, sigma = self.unit, self.V, self.p["sigma"]
        self.history = str(rng.choice(["constant", "step", "ramp", "sinusoid"]))
        size = min(self.p["a"] * 10 ** rng.uniform(-1, 1.3), 0.5) * float(rng.choice([-1, 1]))
        start, lasting = 2.05 * unit, unit * 10 ** rng.uniform(-2, 0.5)
        period = unit * 10 ** rng.uniform(-1, 1)
        omega, loading = 2.0 * math.pi / period, rs.Loading.constant(V)

        def ramp(t):
            rate = size / lasting if start < t < start + lasting else 0.0
            s = 1.0 + size * min(max((t - start) / lasting, 0.0), 1.0)
            return s, rate / s

        def wave(t):
            s = 1.0 + abs(size) * math.sin(omega * t)
            return s, abs(size) * omega * math.cos(omega * t) / s

        self.loading, self.s, self.breaks = {
            "constant": lambda: (loading, lambda t: (1.0, 0.0), []),
            "step": lambda: (
                loading.sigma_step(start, (1.0 + size) * sigma),
                lambda t: (1.0 + size if t > start else 1.0, 0.0),
                [start],
            ),
            "ramp": lambda: (
                loading.sigma_ramp(start, (1.0 + size) * sigma, lasting),
                ramp,
                [start, start + lasting],
            ),
            "sinusoid": lambda: (
                loading.sigma_sinusoid(abs(size) * sigma, period=period),
                wave,
                [],
            ),
        }[self.history]()

    def run(self):
        """The motion, up to its instability if it has one, and whether it has."""
        slider = rs.SpringSlider(**self.p, **self.own, law=self.law)
        start = {"V_start": self.V / 3.0, "rtol": RTOL}
        try:
            times = np.linspace(0.0, self.t_end, POINTS)
            return rs.simulate(slider, self.loading, self.t_end, times=times, **start), False
        except rs.QuasiStaticInstability as error:
            end = BEFORE_RUNAWAY * float(error.best.time[-1])
            times = np.linspace(0.0, end, POINTS)
            return rs.simulate(slider, self.loading, end, times=times, **start), True

    def twin(self, reverses):
        """The textbook, with V itself as a variable where slip reverses."""
        form = {"friction_form": self.form} if self.form == "regularized" else self.own
        kind = Reversing if reverses else Textbook
        return kind(self.law, {**self.p, **form, "s": self.s})

    def __str__(self):
        return f"{self.law}, {self.form}, {self.history}: V = {self.V!r}, {self.p | self.own}"


def compared(case):
    """Error over rtol of a run, its energy residual over rtol, whether it runs away, reverses."""
    run, runs_away = case.run()
    reverses = float(run.V_min) <= 0.0
    if reverses and case.p["M"] == 0.0:
        return None  # (the textbook has no V as a variable then)
    twin, times = case.twin(reverses), run.time.values
    breaks = [t for t in case.breaks if t < times[-1]]
    exact = twin.through(twin.steady(case.V / 3.0), case.V, times, breaks)
    error = twin.differs(run, exact) / RTOL
    return error, abs(float(run.energy_residual)) / RTOL, runs_away, reverses


def magnification(case):
    """What becomes, at most, of a change of any of the variables at the start, over the change."""
    run, _ = case.run()
    twin, times = case.twin(float(run.V_min) <= 0.0), run.time.values
    breaks = [t for t in case.breaks if t < times[-1]]
    start = twin.steady(case.V / 3.0)
    exact, scale, largest = twin.through(start, case.V, times, breaks), twin.sizes(start), 0.0
    for i in range(len(start)):
        y = start + RTOL * scale[i] * np.eye(len(start))[i]
        moved = twin.through(y, case.V, times, breaks)
        largest = max(largest, (np.abs(moved - exact) / scale).max() / RTOL)
    return largest


def main():
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("--n", type=int, default=500)
    options.add_argument("--seed", type=int, default=17)
    asked = options.parse_args()
    warnings.simplefilter("ignore")
    errors, residuals, lost, away, back = [], [], 0, 0, 0
    for k in range(asked.n):
        case = Case(np.random.default_rng([asked.seed, k]))
        try:
            found = compared(case)
        except (AssertionError, OverflowError, ValueError) as error:  # the oracle gives up
            print(f"{k}: no oracle, {str(error)[:60]!r}: {case}", flush=True)
            found = None
        except rs.SolverError as error:
            print(f"{k}: no run, {str(error)[:60]!r}: {case}", flush=True)
            found = None
        if found is None:
            lost += 1
            continue
        error, residual, runs_away, reverses = found
        errors.append(error)
        residuals.append(residual)
        away, back = away + runs_away, back + reverses
        if error > 100.0:
            told = f"magnification {magnification(case):.3g}"
            print(f"{k}: {error:.3g} rtol, {told}: {case}", flush=True)
    print(
        f"{len(errors)} runs ({away} run away, {back} reverse), {lost} without an oracle or a run; "
        f"error over rtol: median {np.median(errors):.2g}, 90 % {np.percentile(errors, 90):.2g}, "
        f"worst {max(errors):.3g}, beyond 100: {sum(x > 100 for x in errors)}; energy residual "
        f"over rtol: {max(residuals):.2g} at most"
    )


if __name__ == "__main__":
    main()
