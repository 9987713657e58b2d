"""Built-in laws against their textbook forms: `python benchmarks/laws.py [--law NAME] [part ...]`.

runs    random sliders with mass and without, against SciPy's Radau: errors over rtol
modes   eigenvalues of steady sliding, against a Jacobian by central differences
cycles  amplitude and period of limit cycles, against Newton's method on SciPy's LSODA or Radau

The textbook forms are those of the tests (tests/helpers/textbook.py), plain Python in SI; they
share no code with the package.  All three parts together take half an hour of one core.

Where an error is beyond 100 rtol, the motion itself is told: by how much it magnifies a change of
its start.
"""

import argparse
import math
import sys
import warnings
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import ratestate as rs
from ratestate.friction.laws import LAWS

sys.path.insert(0, str(Path(__file__).parents[1] / "tests/helpers"))
from textbook import OF_LAW, Textbook, drawn

Textbook.method, Textbook.tolerance = "Radau", 1e-10

RTOL = 1e-6
SLIDERS, CYCLES = 200, 20
# A run without mass is compared up to this part of the time to its instability.
BEFORE_RUNAWAY = 0.98
# Of the oracle of cycles.  It is taken twice, and the difference is what it leaves in doubt.
FINE, FINEST = 1e-11, 1e-12
# Of a trial of LSODA's in ln V or ln theta, of which the exponential must be a number.
LARGEST = 300.0
# Returns in which a cycle of the oracle has to settle, before Newton's method takes over.
SETTLING, COARSE, MOST_ITERATIONS = 30, 1e-7, 12
METHODS = "LSODA", "Radau"  # the second, ten times slower, where the first gives up


def runs(law, seed):
    """Worst errors of 200 sliders with mass, and of as many without, over rtol."""
    for mass in (True, False):
        rng, ratios, runaways = np.random.default_rng([seed, mass]), [], 0
        for _ in range(SLIDERS):
            parameters, V = drawn(law, rng)
            parameters["M"] *= mass
            ratio, ran_away = compared(law, parameters, V)
            ratios.append((ratio, parameters, V))
            runaways += ran_away
        ratios.sort(key=lambda case: -case[0])
        values = [case[0] for case in ratios]
        print(
            f"{law}, {'with' if mass else 'without'} mass: error over rtol worst {values[0]:.3g}, "
            f"median {np.median(values):.3g}, beyond 100: {sum(x > 100 for x in values)}; "
            f"{runaways} run away",
            flush=True,
        )
        for ratio, parameters, V in ratios:
            if ratio > 100:
                factor = magnification(law, parameters, V)
                print(f"    {ratio:.3g}, magnification {factor:.3g}: V = {V!r}, {parameters}")


def ends(law, parameters, V):
    """Until when a slider is compared, and whether it runs away then."""
    slider, end = rs.SpringSlider(**parameters, law=law), 10.0 * parameters["Dc"] / V
    try:
        rs.simulate(slider, rs.Loading.constant(V), end, times=[end], V_start=V / 3.0, rtol=RTOL)
    except rs.QuasiStaticInstability as error:
        return BEFORE_RUNAWAY * float(error.best.time[-1]), True
    return end, False


def magnification(law, parameters, V):
    """What becomes, at most, of a change of any of the variables at the start, over the change."""
    twin, times = Textbook(law, parameters), np.linspace(0.0, ends(law, parameters, V)[0], 11)
    start = twin.steady(V / 3.0)
    scale = np.array([parameters["a"], *np.ones(len(start) - 1)])
    exact, largest = twin.solve(start, V, times), 0.0
    for i in range(len(start)):
        y = start + RTOL * scale[i] * np.eye(len(start))[i]
        if parameters["M"] == 0.0:  # friction balances the spring
            y[1] = math.log(twin.velocity(y[0], np.exp(y[2:])))
        largest = max(largest, (np.abs(twin.solve(y, V, times) - exact) / scale).max() / RTOL)
    return largest


def compared(law, parameters, V):
    """Largest error in tau/(a sigma), ln V and ln theta over rtol, and whether it runs away."""
    end, ran_away = ends(law, parameters, V)
    times, slider = np.linspace(0.0, end, 11), rs.SpringSlider(**parameters, law=law)
    loading = rs.Loading.constant(V)
    run = rs.simulate(slider, loading, end, times=times, V_start=V / 3.0, rtol=RTOL)
    twin = Textbook(law, parameters)
    exact = twin.solve(twin.steady(V / 3.0), V, times)
    logs = [np.log(run[name].values) for name in ("V", *LAWS[law].states)]
    found = np.transpose([run.tau.values / parameters["sigma"], *logs])
    scale = np.array([parameters["a"], *np.ones(len(logs))])
    return float((np.abs(found - exact) / scale).max() / RTOL), ran_away


def modes(law, seed):
    """Eigenvalues of 200 sliders: the largest difference, over the largest eigenvalue and own."""
    rng, of_largest, of_own = np.random.default_rng(seed), [], []
    for _ in range(SLIDERS):
        parameters, V = drawn(law, rng)
        twin = Textbook(law, parameters)
        exact = np.linalg.eigvals(twin.jacobian(twin.steady(V), V))
        found = rs.stability(rs.SpringSlider(**parameters, law=law), V).eigenvalues.values
        off = np.abs(found[:, None] - exact).min(axis=1)
        of_largest.append((off / np.abs(exact).max()).max())
        of_own.append((off / np.abs(found)).max())
    print(
        f"{law}: eigenvalues off by {max(of_largest):.2g} of the largest, by {max(of_own):.2g} of "
        f"their own size (median {np.median(of_own):.2g})",
        flush=True,
    )


class Lost(Exception):
    """The oracle does not find a cycle."""


class Section:
    """The return map of V = V_lp of a textbook slider, by one of `METHODS`."""

    def __init__(self, law, parameters, V, method):
        self.twin, self.V, self.ln_V = Textbook(law, parameters), V, math.log(V)
        self.unit, self.method = parameters["Dc"] / V, method
        self.scale = np.array([parameters["a"], *np.ones(len(self.twin.D))])  # of a point

    def _integrated(self, y, span, tol, event=None):
        run = solve_ivp(
            lambda t, y: self.twin.rates(np.clip(y, -LARGEST, LARGEST), self.V),
            (0.0, span),
            y,
            self.method,
            events=event,
            jac=lambda t, y: self.twin.jacobian(np.clip(y, -LARGEST, LARGEST), self.V),
            rtol=tol,
            atol=tol * np.insert(self.scale, 1, 1.0),
        )
        if not run.success:
            raise Lost
        return run

    def next(self, y, direction, tol):
        """The state and time at the next crossing of V_lp, upward (1) or downward (-1)."""

        def speed(t, y):
            return y[1] - self.ln_V if t > 1e-3 * self.unit else -direction

        speed.terminal, speed.direction = True, direction
        run = self._integrated(y, 1e4 * self.unit, tol, speed)
        if not run.t_events[0].size:
            raise Lost
        # Dense output is less exact than steps: from the last one on by integration.
        y, t = run.y[:, -2], run.t[-2]
        ahead = run.t_events[0][0] - t
        for _ in range(3):
            y = self._integrated(y, ahead, tol).y[:, -1]
            t += ahead
            ahead = (self.ln_V - y[1]) / self.twin.rates(y, self.V)[1]
        return y, t

    def around(self, z, tol):
        """From a point z = (tau/sigma, ln theta, ...) where V rises to where it does again.

        The point, the time, and the amplitude of the stress.
        """
        lowest, down = self.next(np.insert(z, 1, self.ln_V), -1, tol)
        top, up = self.next(lowest, 1, tol)
        return np.delete(top, 1), down + up, top[0] - lowest[0]

    def settled(self):
        """A point near the cycle that the slider comes to from steady sliding at V_lp/10."""
        z = np.delete(self.next(self.twin.steady(self.V / 10.0), 1, COARSE)[0], 1)
        for _ in range(SETTLING):
            z = self.around(z, COARSE)[0]
        return z

    def cycle(self, z, tol):
        """A cycle's point, period and amplitude, by Newton's method from z on."""
        for _ in range(MOST_ITERATIONS):
            columns = []
            for change in 1e-5 * np.diag(self.scale):
                up, down = (self.around(z + sign * change, tol)[0] for sign in (1, -1))
                columns.append((up - down) / (2.0 * change.sum()))
            off = self.around(z, tol)[0] - z
            step = np.linalg.solve(np.eye(len(z)) - np.transpose(columns), off)
            z = z + step
            if (np.abs(step) / self.scale).max() < 1e3 * tol:
                return z, *self.around(z, tol)[1:]
        raise Lost


def oracle(law, parameters, V):
    """Period and amplitude of a slider's cycle, an array, at both tolerances; None if not found."""
    for method in METHODS:
        section = Section(law, parameters, V, method)
        try:
            z, *rough = section.cycle(section.settled(), FINE)
            return np.array(rough), np.array(section.cycle(z, FINEST)[1:])
        except Lost:
            continue
    return None


def cycles(law, seed):
    """Amplitude and period of 20 cycles of sliders below their critical stiffness."""
    rng, found, passed_over = np.random.default_rng(seed), [], 0
    while len(found) < CYCLES:
        parameters, V = drawn(law, rng)
        parameters["K"] = rng.uniform(0.3, 0.97) * rs.SpringSlider(**parameters, law=law).K_c(V)
        if parameters["K"] == 0.0:  # stable on any spring
            continue
        try:
            mine = rs.limit_cycle(rs.SpringSlider(**parameters, law=law), V)
        except rs.NotConverged as error:
            mine = error.best
        exact = (
            oracle(law, parameters, V) if int(mine.status) == 0 == int(mine.returns) - 1 else None
        )
        if exact is None:
            print(f"    passed over, status {int(mine.status)}: V = {V!r}, {parameters}")
            passed_over += 1
            continue
        both = np.array([float(mine.period), float(mine.amplitude)])
        off, doubt = (np.abs(one / exact[1] - 1.0).max() for one in (both, exact[0]))
        found.append((off, doubt))
        if off > 1e-7:
            print(f"    {off:.3g} (in doubt {doubt:.2g}): V = {V!r}, {parameters}")
    off, doubt = np.transpose(found)
    print(
        f"{law}: amplitude and period of {CYCLES} cycles off by {off.max():.2g} at most, median "
        f"{np.median(off):.2g}; the oracle's own tolerances differ by {doubt.max():.2g} at most; "
        f"{passed_over} sliders passed over",
        flush=True,
    )


PARTS = {"runs": runs, "modes": modes, "cycles": cycles}


def main():
    options = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    options.add_argument("parts", nargs="*", help=f"{' '.join(PARTS)}; all by default")
    options.add_argument("--law", choices=OF_LAW, help="all by default")
    options.add_argument("--seed", type=int, default=16)
    asked = options.parse_args()
    if unknown := set(asked.parts) - set(PARTS):
        options.error(f"no such part: {' '.join(sorted(unknown))}; choose from {' '.join(PARTS)}")
    warnings.filterwarnings("ignore", module="scipy")  # of LSODA, which gives up
    for part in asked.parts or PARTS:
        for law in [asked.law] if asked.law else OF_LAW:
            PARTS[part](law, asked.seed)


if __name__ == "__main__":
    main()
