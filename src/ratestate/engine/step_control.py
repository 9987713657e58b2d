"""Step control: whether a step of Rodas5P is accepted, and how large the next one is."""

import math

from . import rows as R
from .jit import inlined

# A factor below 1/5 or above 5 says more about the estimate than about the solution.
SAFETY, SHRINK, GROW = 0.85, 0.2, 5.0


@inlined
def step_size(h, t_break, t, t_low):
    """The step to try, in T: never past the next breakpoint, nor just short of it."""
    left = (t_break - t) - t_low
    return left if h * (1.0 + 1e-9) >= left else h


@inlined
def control_step(s, l):
    """Accept or reject a step of lane l (OK, BAD) and choose the next size, by a PI controller.

    Powers are taken by square roots, which vectorise.
    """
    err, h, planned = s[R.ERROR + l], s[R.H_USED + l], s[R.H + l]
    finite = err < 1e300
    ok = err <= 1.0
    quarter = math.sqrt(math.sqrt(err))
    eighth = math.sqrt(quarter)
    sixteenth = math.sqrt(eighth)
    factor = SAFETY * s[R.MEMORY + l] / (eighth * sixteenth)
    rejected = SAFETY / quarter
    factor = factor if ok else rejected
    factor = factor if factor < GROW else GROW
    factor = factor if factor > SHRINK else SHRINK
    factor = factor if finite else SHRINK
    h_next = h * factor
    # A step cut short by a breakpoint says nothing against the size planned before it.
    h_next = planned if ok & (h < planned) & (h_next < planned) else h_next
    s[R.OK + l] = 1.0 if ok else 0.0
    s[R.BAD + l] = 0.0 if finite else 1.0
    s[R.H_NEXT + l] = h_next
    s[R.MEMORY_NEW + l] = sixteenth if sixteenth > 0.05 else 0.05
