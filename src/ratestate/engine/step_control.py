"""Step control: whether a step of Rodas5P is accepted, and how large the next one is."""

from ..friction.functions import sqrt, where
from . import rows as R

# A factor below 1/5 or above 5 says more about the estimate than about the solution.
SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0


def step_size(h, t_break, t, t_low):
    """The step to try, in T: never past the next breakpoint, nor just short of it."""
    left = (t_break - t) - t_low
    return where(h * (1.0 + 1e-9) >= left, left, h)


def control_step(s, l):
    """Accept or reject a step of lane l (OK, BAD) and choose the next size, by a PI controller.

    Powers are taken by square roots, which vectorise.
    """
    err, h, planned = s[R.ERROR + l], s[R.H_USED + l], s[R.H + l]
    finite = err < 1e300
    ok = err <= 1.0
    quarter = sqrt(sqrt(err))
    eighth = sqrt(quarter)
    sixteenth = sqrt(eighth)
    factor = SAFETY * s[R.MEMORY + l] / (eighth * sixteenth)
    rejected = SAFETY / quarter
    factor = where(ok, factor, rejected)
    factor = where(factor < GROW, factor, GROW)
    factor = where(factor > SHRINK, factor, SHRINK)
    factor = where(finite, factor, SHRINK)
    h_next = h * factor
    # A step cut short by a breakpoint says nothing against the size planned before it.
    h_next = where(ok & (h < planned) & (h_next < planned), planned, h_next)
    s[R.OK + l] = where(ok, 1.0, 0.0)
    s[R.BAD + l] = where(finite, 0.0, 1.0)
    s[R.H_NEXT + l] = h_next
    s[R.MEMORY_NEW + l] = where(sixteenth > 0.05, sixteenth, 0.05)
