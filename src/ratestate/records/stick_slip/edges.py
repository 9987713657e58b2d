"""Where an extreme is that has no vertex: at the edge of the loading, next to a fall.

The loading is a polynomial up to where samples leave it for the fall.  They have begun to leave
before noise lets one see it: the departure from a polynomial grows as the square of the time from
the extreme, where the fall begins or ends with a finite acceleration, so that it takes as long to
pass from nothing to `LEFT` standard deviations as from there to four times as many.  If noise hides
the fall in one event, the mean departure of all events shows it.
"""

from typing import NamedTuple

import numpy as np

#: standard deviations of a sample from a polynomial that it has left
LEFT = 4.0
#: samples from a window in which it must be left: else it is none that the fall bounds
BEYOND = 4


class Places(NamedTuple):
    """Where m extremes are, in u, the standard errors of that, and whether the fall bounds them."""

    u: np.ndarray
    error: np.ndarray
    bounded: np.ndarray


def edges(samples, span, scales, c, fall, sign, sd):
    """The `Places` of the extremes of polynomials c (m, size) on the side of the fall.

    samples : t and y, (n,) each, of the whole record
    span : (m,) first samples of the windows, those after their last, those after middles of falls
    scales : times (m,) at which u = 0, time in which it grows by 1, and (m,) stress at which c = 0
    """
    first, last, middle = span
    size = np.arange(c.shape[1])

    def u_and_off(rows):
        """u of samples (m, rows), and how far these are from the polynomials."""
        u = (samples[0][rows] - scales[0][:, None]) / scales[1]
        off = samples[1][rows] - scales[2][:, None] - (u[..., None] ** size * c[:, None]).sum(-1)
        return u, off

    if fall == 0:
        u, _ = u_and_off(np.stack([first, last - 1], axis=1))
        slopes = (size[1:] * u[..., None] ** size[:-1] * c[:, None, 1:]).sum(-1)
        best = u[np.arange(len(u)), np.argmax(sign * slopes, axis=1)]
        return Places(best, np.zeros(len(u)), np.ones(len(u), bool))
    end = last - 1 if fall > 0 else first
    steps = np.maximum(fall * (middle - end) + (fall < 0), 1)
    rows = end[:, None] + fall * np.arange(int(steps.max()) + 1)  # (the window's last included)
    inside = (rows >= 0) & (rows < samples[0].size) & (np.arange(rows.shape[1]) <= steps[:, None])
    u, off = u_and_off(np.clip(rows, 0, samples[0].size - 1))
    off = np.where(inside, off, 0.0)
    off[:, 0] = 0.0
    count = np.maximum(inside.sum(axis=0), 1)
    own = _leaves(np.abs(off), np.full(off.shape, sd), inside)
    mean = np.broadcast_to(np.abs(off.sum(axis=0) / count), off.shape)
    shared = _leaves(mean, np.broadcast_to(sd / np.sqrt(count), off.shape), inside)
    return _placed(u, fall, *(np.where(own[0] > 0, a, b) for a, b in zip(own, shared, strict=True)))


def _leaves(off, sd, inside):
    """(m,) samples from the window at which it is left, 0 for none near it, and at which by far."""
    index = np.arange(off.shape[1])
    near = (off > LEFT * sd) & inside & (index <= BEYOND)
    left = np.where(near.any(axis=1), near.argmax(axis=1), 0)
    far = (off > 4.0 * LEFT * sd) & inside & (index >= left[:, None])
    last = inside.sum(axis=1) - 1
    return left, np.where(far.any(axis=1), far.argmax(axis=1), last)


def _placed(u, fall, left, far):
    """`Places` before the samples that have left the windows.

    If nothing is seen to leave a window, the extreme is at its end, or up to the fall's middle.
    """
    event = np.arange(len(u))
    step = np.abs(u[event, left] - u[event, np.maximum(left - 1, 0)])
    delay = np.abs(u[event, far] - u[event, left])
    # a time between two samples is known to sqrt(1/12) of a step, the delay to sqrt(2/12)
    place, error = u[event, left] - fall * (0.5 * step + delay), np.hypot(0.5 * step, 0.5 * delay)
    bounded = left > 0
    return Places(
        np.where(bounded, place, u[:, 0]),
        np.where(bounded, error, 0.5 * delay),
        bounded,
    )
