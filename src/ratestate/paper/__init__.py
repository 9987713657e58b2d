"""The figures of Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026, and its claims.

``parameters`` has the paper's values, ``fig1`` to ``fig6`` its figures, ``claims.toml`` its claims.
Figures beyond the paper are ``atlas_figure``, ``branches``, ``basins`` and ``scheme``.  The modules
of figures have `compute`, which returns the numbers, and `draw`.
"""


def __getattr__(name):
    if name != "im2017":
        raise AttributeError(f"module 'ratestate.paper' has no attribute {name!r}")
    from .scheme_run import im2017

    return im2017
