"""Steady friction of a slide, with its drift."""

from .polynomial_windows import is_curved
from .slide_noise import FEWEST, late_part

#: how often the part of a slide that may be steady is halved if it is not
HALVINGS = 2
#: order of steady friction with a drift
LINEAR = 1


def steady_part(t, friction, slide, noise):
    """Rows of the end of a slide in which friction is steady but for a drift; None if it is not."""
    rows = late_part(slide)
    for _ in range(1 + HALVINGS):
        if rows.size < FEWEST:
            return None
        if not is_curved(t, t, friction, rows, LINEAR, noise):
            return rows
        rows = rows[rows.size // 2 :]
    return None
