"""Which points of a long curve are sent to the page."""

import numpy as np

#: most points of a curve
MOST_SENT = 6000


def decimated(*curves):
    """Indices of the points that are sent: all, or the extremes of each of many pieces.

    curves : (n,) each, of the same points
    """
    n = len(curves[0])
    if n <= MOST_SENT:
        return slice(None)
    pieces = np.array_split(np.arange(n), MOST_SENT // (2 * len(curves) + 1))
    kept = [0, n - 1]
    for piece in pieces:
        for curve in curves:
            part = curve[piece]
            kept += [piece[0], piece[part.argmin()], piece[part.argmax()]]
    return np.unique(kept)
