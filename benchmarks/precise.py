"""Cycles of spring-sliders in 80-bit floating point, found without the package.

truth.c, compiled with `cc`, takes a slider from one stress maximum to a later one.  Here that map's
fixed points are found, and where their branches fold or their periods double.
"""

import ctypes
import subprocess
from pathlib import Path
from typing import NamedTuple

import mpmath
import numpy as np

STAGES = 9
# Of a step, as an extrapolation foretells it; its error is some ten decades smaller.
TOL, FINER = 1e-6, 1e-8
MOST_STEPS = 200_000
MOST_ITERATIONS, MOST_SECANTS = 15, 40
# Relative corrections: as small as they get, those that no longer fall, and too large to be near.
CLOSED, STUCK, FARTHEST = 1e-18, 1e-9, 0.3
FIRST_SECANT = 1e-5
KEPT, SEEDS = 7, 4  # as in truth.c
X, PSI, PERIOD, X_HIGH, X_LOW, V_MAX, V_MIN = range(KEPT)
BY_X, BY_PSI, BY_KAPPA, BY_ETA = range(1, 1 + SEEDS)
BUILD = Path(__file__).parent.parent / "build"
SOURCE = Path(__file__).with_name("truth.c")
Real = np.longdouble


class NoCycle(Exception):
    """None was found, and why."""


def coefficients():
    """The Radau IIA method as a header; see truth.c."""
    with mpmath.workdps(60):
        steps = mpmath.taylor(
            lambda c: mpmath.legendre(STAGES, 2 * c - 1) - mpmath.legendre(STAGES - 1, 2 * c - 1),
            0,
            STAGES,
        )
        C = sorted(mpmath.polyroots(steps[::-1], maxsteps=200, extraprec=200), key=mpmath.re)
        powers = mpmath.matrix(STAGES, STAGES)
        integrals = mpmath.matrix(STAGES, STAGES)
        for i, c in enumerate(C):
            for k in range(STAGES):
                powers[i, k], integrals[i, k] = c**k, c ** (k + 1) / (k + 1)
        A = integrals * powers**-1
        D = A**-1
        W = [1 / (c * mpmath.fprod(c - other for other in C if other != c)) for c in C]
    tables = {"C[S]": C, "W[S]": W, "A[S][S]": A.tolist(), "D[S][S]": D.tolist()}
    rows = [f"static const real {name} = {_constant(table)};" for name, table in tables.items()]
    return "\n".join([f"enum {{ S = {STAGES} }};", *rows, ""])


def _constant(table):
    """Numbers, or rows of them, as C has them."""
    if isinstance(table, list):
        return f"{{{', '.join(_constant(part) for part in table)}}}"
    return f"{mpmath.nstr(table, 30)}L"


def compiled():
    """The C function `turn`."""
    BUILD.mkdir(exist_ok=True)
    (BUILD / "radau.h").write_text(coefficients())
    library = BUILD / "truth.so"
    command = [
        "cc",
        "-O3",
        "-fno-math-errno",
        "-funroll-loops",
        "-shared",
        "-fPIC",
        f"-I{BUILD}",
        "-o",
        library,
        SOURCE,
        "-lm",
    ]
    try:
        subprocess.run(command, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise SystemExit(f"truth.c needs a C compiler, as `cc`: {error}") from error
    if np.finfo(Real).eps > 1.1e-19:
        raise SystemExit("truth.c needs a long double of 64 bits and more; this machine has none")
    turn = ctypes.CDLL(str(library)).turn
    pointer = ctypes.c_void_p
    number = ctypes.c_int
    turn.argtypes = [number, pointer, pointer, number, number, pointer, pointer]
    return turn


class Slider(NamedTuple):
    """A slider in SI; its numbers are what these doubles say exactly."""

    law: str
    a: float
    b: float
    Dc: float
    sigma: float
    K: float
    M: float
    V_lp: float

    @property
    def numbers(self):
        """kappa, beta and eta."""
        a, b, Dc, sigma, K, M, V = map(Real, self[1:])
        return np.array([K * Dc / (a * sigma), b / a, M * V * V / (a * sigma * Dc)])

    def at(self, parameter, value):
        """The slider with another value of one parameter."""
        return self._replace(**{parameter: value})


class Turn(NamedTuple):
    """From one stress maximum to a later one."""

    values: np.ndarray  # (KEPT,)
    slopes: np.ndarray  # (KEPT, SEEDS) by x and psi at the start, ln kappa and ln eta
    steps: int


class Cycle(NamedTuple):
    """A cycle, stable or not, of the slider whose parameter is larger by the factor exp(shift)."""

    u: np.ndarray  # (2,) x and psi at the stress maximum
    shift: np.longdouble
    turn: Turn
    tangent: np.ndarray | None = None  # (3,) of the branch, d(x, psi, shift)

    @property
    def measures(self):
        """Logarithms of amplitude (of x) and period, and v_max and v_min."""
        values = self.turn.values
        amplitude = values[X_HIGH] - values[X_LOW]
        return np.array([np.log(amplitude), np.log(values[PERIOD]), values[V_MAX], values[V_MIN]])

    @property
    def turning(self):
        """The parameter's change along the branch: 0 where it folds."""
        return self.tangent[2]

    @property
    def doubling(self):
        """The product of 1 + m over the multipliers m: 0 where the period doubles."""
        return _determinant(self.turn.slopes[:2, :2] + np.eye(2, dtype=Real))


class Solver:
    """Turns of sliders, and their cycles."""

    def __init__(self):
        self._turn = compiled()

    def turn(self, law, numbers, u, returns, tol):
        """`Turn` from u = (x, psi); NoCycle where it does not come back."""
        numbers, u = np.asarray(numbers, Real), np.ascontiguousarray(u, Real)
        size = min(Real(1), abs(u).max())
        given = np.concatenate([numbers, [Real(tol), size]])
        out, taken = np.zeros((KEPT, 1 + SEEDS), Real), ctypes.c_int(0)
        status = self._turn(
            int(law == "aging"),
            given.ctypes.data,
            u.ctypes.data,
            returns,
            MOST_STEPS,
            out.ctypes.data,
            ctypes.addressof(taken),
        )
        if status:
            raise NoCycle(("", "a landing failed", "too many steps", "not rising")[status])
        return Turn(out[:, 0], out[:, 1:], taken.value)

    def cycle(self, law, numbers, u, returns=1, tol=TOL):
        """The `Cycle` near u, by Newton's method."""
        u, last = np.array(u, Real), np.inf
        for _ in range(MOST_ITERATIONS):
            turn = self.turn(law, numbers, u, returns, tol)
            step = _solved(turn.slopes[:2, :2] - np.eye(2, dtype=Real), u - turn.values[:2])
            size = float(abs(step).max() / abs(u).max())
            if not size < FARTHEST:
                break
            if size <= CLOSED or (size <= STUCK and size > 0.1 * last):
                return Cycle(u, Real(0), turn)
            u, last = u + step, size
        raise NoCycle("Newton's method does not converge")

    def special(self, law, numbers, u, parameter, test, tol=TOL):
        """The `Cycle` nearest to u on its branch at which `test` of a `Cycle` is 0, by secants.

        They go along the branch's direction at its point nearest to u.
        """
        weights = np.append(np.abs(np.array(u, Real)), Real(1))
        y = np.append(np.array(u, Real), Real(0))
        here = self._on_branch(law, numbers, parameter, y, None, weights, tol)
        normal, y = here.tangent / weights, np.append(here.u, here.shift)
        s, value = Real(0), test(here)
        next_s, last = Real(FIRST_SECANT), here
        for _ in range(MOST_SECANTS):
            guess = np.append(last.u, last.shift) + (next_s - s) * normal * weights
            new = self._on_branch(law, numbers, parameter, guess, normal, weights, tol)
            before, value, change = value, test(new), next_s - s
            s, last = next_s, new
            step = -value * change / (value - before) if value != before else Real(0)
            next_s = s + step
            if abs(step) <= CLOSED or (abs(step) < STUCK and abs(step) > 0.1 * abs(change)):
                return new
            if not abs(next_s) < FARTHEST:
                break
        raise NoCycle("the special point was not found")

    def _on_branch(self, law, numbers, parameter, guess, normal, weights, tol):
        """The `Cycle` on the plane through a guess, or nearest to it where `normal` is None.

        In the coordinates (x, psi, shift)/weights.
        """
        y, last = guess, np.inf
        for _ in range(MOST_ITERATIONS):
            turn = self.turn(law, shifted(numbers, parameter, y[2]), y[:2], 1, tol)
            slopes = np.column_stack([turn.slopes[:, :2], turn.slopes @ direction(parameter)])
            rows = (slopes[:2] - np.eye(2, 3, dtype=Real)) * weights
            scale = abs(rows).max(axis=1)
            tangent = np.cross(*(rows / scale[:, None]))
            tangent /= np.sqrt(tangent @ tangent)
            across = tangent if normal is None else normal
            off = Real(0) if normal is None else across @ ((guess - y) / weights)
            gap = np.append((y[:2] - turn.values[:2]) / scale, off)
            step = _solved(np.vstack([rows / scale[:, None], across]), gap)
            size = float(abs(step).max())
            if not size < FARTHEST:
                break
            before, y, previous, last = y, y + weights * step, last, size
            if size <= CLOSED or (size <= STUCK and size > 0.1 * previous):
                if normal is not None and tangent @ normal < 0:
                    tangent = -tangent
                return Cycle(before[:2], before[2], turn, tangent * weights)
        raise NoCycle("Newton's method does not converge on the branch")


def direction(parameter):
    """(SEEDS,) what d ln(parameter) is in directions of `Turn.slopes`."""
    by = {"K": (1, 0), "M": (0, 1), "V_lp": (0, 2)}[parameter]
    return np.array([0, 0, *by], Real)


def shifted(numbers, parameter, shift):
    """The numbers of a slider whose parameter is larger by the factor exp(shift)."""
    by = direction(parameter)[2:] * shift
    return np.array([numbers[0] * np.exp(by[0]), numbers[1], numbers[2] * np.exp(by[1])])


def _determinant(m):
    return m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]


def _solved(matrix, right):
    """The solution of a linear system; numpy's own is in double precision."""
    rows = np.column_stack([matrix, right])
    n = len(rows)
    for k in range(n):
        pivot = k + int(np.argmax(abs(rows[k:, k])))
        rows[[k, pivot]] = rows[[pivot, k]]
        if not abs(rows[k, k]) > 0:
            raise NoCycle("a singular matrix")
        rows[k] /= rows[k, k]
        for r in range(n):
            if r != k:
                rows[r] -= rows[r, k] * rows[k]
    return rows[:, -1]
