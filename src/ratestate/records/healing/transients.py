"""How friction approaches its steady level after reloading.

Near steady sliding the equations of a slider without mass are linear.  Friction is then the sum of
two exponentials of slip, or an oscillation with an exponential envelope (Ruina 1983
doi:10.1029/JB088iB12p10359).  The lengths are properties of the slider, the same after every hold.
The amplitudes differ.  Farther from steady sliding the next terms of a series are products of the
two.
"""

from typing import NamedTuple

import numpy as np

#: shorter length of the second exponential, as a fraction; or its wave number, times the length
FASTER, WAVES = (1.0, 0.5, 0.2, 0.05), (0.7, 1.5, 3.0, 6.0)
#: number of decay lengths; shortest and longest as a fraction of a slide
LENGTHS, SHORTEST, LONGEST = 18, 2e-3, 0.5
#: columns of a transient: linear, and with products
LINEAR, QUADRATIC = 2, 5
#: samples of a slide that are compared with each shape; independent deviations among them
COMPARED, INDEPENDENT = 150, 15
#: least weight of a shape, as a fraction of the best one's
LEAST = 1e-3


class Shape(NamedTuple):
    """A transient's decay length [m], with a second, shorter one or a wave."""

    length: float
    faster: float  # second length as a fraction; 0 for a wave
    wave: float

    def columns(self, slip):
        """(n, QUADRATIC) a basis of transients at slip (n,) [m]; of order 1 at its start."""
        u = (slip - slip[0]) / self.length
        fade = np.exp(-u)
        if self.wave:
            one, two = fade * np.cos(self.wave * u), fade * np.sin(self.wave * u)
        elif self.faster == 1.0:
            one, two = fade, u * fade
        else:
            one, two = fade, (fade - np.exp(-u / self.faster)) / (1.0 - self.faster)
        return np.column_stack([one, two, one * one, one * two, two * two])


def shapes_of(friction, slip, tails, level):
    """List of `Shape`s, and ln of their weights, that may describe tails (list of rows).

    level : standard deviation of the noise

    They are compared with friction from each peak on.  None of them is exact there, so weights
    follow from the misfit relative to the least one.
    """
    if not tails:
        return [], np.zeros(0)
    distance = float(np.median([np.ptp(slip[rows]) for rows in tails]))
    lengths = distance * np.geomspace(SHORTEST, LONGEST, LENGTHS)
    forms = [(faster, 0.0) for faster in FASTER] + [(0.0, wave) for wave in WAVES]
    shapes = [Shape(length, *form) for length in lengths for form in forms]
    misfit = np.mean([np.log(_misfits(friction, slip, rows, shapes, level)) for rows in tails], 0)
    weights = -INDEPENDENT * (misfit - misfit.min())
    kept = np.flatnonzero(weights > np.log(LEAST))
    return [shapes[i] for i in kept], weights[kept]


def _misfits(friction, slip, rows, shapes, level):
    """Standard deviation of friction in these rows about a level, a drift and each of shapes."""
    rows = rows[:: max(rows.size // COMPARED, 1)]
    y, x = friction[rows], slip[rows]
    straight = np.column_stack([np.ones(rows.size), (x - x[0]) / np.ptp(x)])
    misfits = []
    for shape in shapes:
        columns = np.column_stack([straight, shape.columns(x)])
        rest = y - columns @ np.linalg.lstsq(columns, y, rcond=1e-6)[0]
        misfits.append(np.hypot(np.sqrt(np.mean(rest**2)), level))
    return np.array(misfits)
