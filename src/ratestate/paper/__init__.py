"""The figures of Im, Marone & Elsworth (2019), doi:10.1016/j.jmps.2018.08.026, and its claims.

``parameters`` has the paper's values, ``fig1`` to ``fig6`` its figures, ``claims.toml`` its claims.
Figures beyond the paper are ``atlas_figure``, ``branches``, ``basins`` and ``scheme``.  The modules
of figures have `compute`, which returns the numbers, and `draw`.
"""

from importlib import import_module

__all__ = ["im2017", "parameters"]


def __getattr__(name):
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "parameters":
        return import_module(f"{__name__}.parameters")
    return import_module(f"{__name__}.scheme_run").im2017


def __dir__():
    return __all__
