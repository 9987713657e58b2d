"""The dense output of a step: polynomials in the fraction of the step that is over, 0 to 1.

Their coefficients, the constant first, stand in rows of the lane buffer: of degree 4 after a step
of Rodas5P, of `recurrences.ORDER` after one of the Taylor method.
"""

from . import rows as R

#: the last step of Newton's method, in fractions of a step: its square is below rounding
CONVERGED = 1e-9


def terms_of(run, l):
    """How many coefficients each number's polynomial has in the lane's step."""
    return run.shape.terms if run.s[R.TAYLOR + l] > 0.0 else R.OF_RODAS5P


def component(run, l, i, at):
    """Number i of (x, v, psi...) at a place in the lane's step; its first and second derivative."""
    s, shape = run.s, run.shape
    row, last = shape.c + i * shape.terms * R.LANES + l, terms_of(run, l) - 1
    y, dy, bend = s[row + last * R.LANES], 0.0, 0.0
    for k in range(1, last + 1):
        bend = dy + at * bend
        dy = y + at * dy
        y = s[row + (last - k) * R.LANES] + at * y
    return y, dy, 2.0 * bend


def state_at(run, l, at, work, place):
    """Put x, v and each psi at a place in the lane's step into `work`, and their derivatives."""
    n = 2 + run.shape.states
    for i in range(n):
        y, dy, _ = component(run, l, i, at)
        work[place + i], work[place + n + i] = y, dy


def extreme_of_v(run, l):
    """Where in 0..1 v is extreme (Newton inside a bracket).

    Where its derivative has one sign at both ends, the end (0.0 or 1.0) where it is smaller in
    size.
    """
    low, high = 0.0, 1.0
    _, d_low, _ = component(run, l, 1, low)
    _, d_high, _ = component(run, l, 1, high)
    if (d_low < 0.0) == (d_high < 0.0):
        return 0.0 if abs(d_low) < abs(d_high) else 1.0
    at = d_low / (d_low - d_high)
    for _ in range(60):
        _, d, bend = component(run, l, 1, at)
        if (d < 0.0) == (d_low < 0.0):
            low = at
        else:
            high = at
        step = d / bend if bend != 0.0 else 2.0
        new = at - step
        if abs(step) < CONVERGED:
            return new
        at = new if low < new < high else 0.5 * (low + high)
    return at
