"""The noise of friction that the slides of a record show, each in the part that may be steady."""

import math

import numpy as np

from ..kit.estimated_noise import estimated_noise
from ..kit.noise import Noise
from ..kit.polynomial_windows import window_of
from ..kit.sample_noise import rounding

#: part of a slide that may be steady: its end; fewest samples of it
STEADY, FEWEST = 0.5, 12
#: most samples of a slide, and most slides, from which noise is estimated
MOST, SLIDES = 2000, 8
#: order of friction in these; noise of one, as a multiple of the least, that counts as a transient
SMOOTH, NOISIER = 3, 2.0
#: least relative noise of a sample: numbers of an instrument have 24 bits at most
SINGLE = 2.0**-24


def late_part(slide):
    """Rows of the part of a slide (rows) in which friction may be steady: its second half."""
    return slide[slide.size - int(STEADY * slide.size) :]


def noise_of_slides(t, friction, slides):
    """The `Noise` of friction (n,) at times t in the late parts of slides (list of rows).

    Slides that seem noisier than the quietest one, by `NOISIER`, are not yet steady and left out.
    The resolution of friction is noise, too.  None if no slide has `FEWEST` samples in that part.
    """
    parts = [late_part(rows)[-MOST:] for rows in slides]
    parts = [rows for rows in parts if rows.size >= FEWEST]
    if not parts:
        return None
    chosen = np.unique(np.linspace(0, len(parts) - 1, SLIDES).round().astype(int))
    parts = [parts[i] for i in chosen]
    least = max(rounding(friction), SINGLE * np.abs(friction).max())
    levels = np.array([_noise(t, friction, [rows], least).level for rows in parts])
    most = NOISIER * levels.min()
    return _noise(t, friction, [parts[i] for i in np.flatnonzero(levels <= most)], least)


def _noise(t, friction, parts, least):
    """The `Noise` in parts of slides, in each of which friction is a cubic polynomial of time.

    least : smallest standard deviation of a sample
    """
    columns = np.zeros((sum(rows.size for rows in parts), len(parts) * (SMOOTH + 1)))
    first = 0
    for i, rows in enumerate(parts):
        block = slice(i * (SMOOTH + 1), (i + 1) * (SMOOTH + 1))
        columns[first : first + rows.size, block] = window_of(t, rows, SMOOTH).basis(t[rows])
        first += rows.size
    rows = np.concatenate(parts)
    residual = friction[rows] - columns @ np.linalg.lstsq(columns, friction[rows])[0]
    if np.std(residual) <= least:
        return Noise(least)
    noise = estimated_noise(t[rows], residual, columns)
    # of what is slower than a part nothing is known but how fast it spreads, as red^2/time
    longest = max(float(t[rows[-1]] - t[rows[0]]) for rows in parts)
    if noise.exponent is not None or noise.time <= longest:
        return noise
    return noise._replace(red=noise.red * math.sqrt(longest / noise.time), time=longest)
