"""Long curves are thinned before they are sent."""

import numpy as np

from ratestate_explorer.picture import MOST_SENT, decimated


def test_thinned_curves_keep_their_extremes():
    x = np.sin(np.arange(100_000.0)) * np.linspace(1.0, 2.0, 100_000)
    which = decimated(x, -x)
    assert len(which) <= MOST_SENT
    assert {0, 99_999, int(x.argmin()), int(x.argmax())} <= set(which.tolist())
    assert (np.diff(which) > 0).all()


def test_short_curves_are_sent_whole():
    x = np.arange(MOST_SENT + 1.0)
    assert decimated(x[:-1], x[:-1]) == slice(None)
    assert 2 < len(decimated(x, x)) < MOST_SENT
