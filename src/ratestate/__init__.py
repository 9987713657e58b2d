"""Spring-slider dynamics under rate-and-state friction.

>>> import ratestate as rs
>>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
>>> round(slider.V_c, 6)  # m/s
0.003162

Nothing heavy is loaded until it is used.
"""

import sys
import types
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .arrays import logspace
    from .branch import continue_cycle
    from .cycles import limit_cycle
    from .errors import (
        NotConverged,
        ParameterError,
        QuasiStaticInstability,
        RateStateError,
        SolverError,
    )
    from .fitting.verb import fit
    from .hopf import bautin, hopf
    from .lab import read_lab
    from .loading import Loading
    from .simulate import simulate
    from .slider import SpringSlider
    from .steady import stability
    from .sweeps.verb import sweep

__all__ = [
    "Loading",
    "NotConverged",
    "ParameterError",
    "QuasiStaticInstability",
    "RateStateError",
    "SolverError",
    "SpringSlider",
    "bautin",
    "continue_cycle",
    "fit",
    "hopf",
    "limit_cycle",
    "logspace",
    "read_lab",
    "simulate",
    "stability",
    "sweep",
]

#: public name -> module that defines it
_HOMES = {
    "CompilationError": "errors",
    "Loading": "loading",
    "NotConverged": "errors",
    "ParameterError": "errors",
    "QuasiStaticInstability": "errors",
    "RateStateError": "errors",
    "RecordWarning": "errors",
    "SolverError": "errors",
    "SpringSlider": "slider",
    "StoreError": "errors",
    "FitWarning": "errors",
    "bautin": "hopf",
    "continue_cycle": "branch",
    "fit": "fitting.verb",
    "hopf": "hopf",
    "limit_cycle": "cycles",
    "logspace": "arrays",
    "read_lab": "lab",
    "simulate": "simulate",
    "stability": "steady",
    "sweep": "sweeps.verb",
}


def __getattr__(name):
    if name == "__version__":
        from importlib.metadata import version

        value = version("ratestate")
    elif name in _HOMES:
        from importlib import import_module

        value = getattr(import_module(f"ratestate.{_HOMES[name]}"), name)
    else:
        raise AttributeError(f"module 'ratestate' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__():
    return [*__all__, "__version__"]


class _Package(types.ModuleType):
    """Keeps the verbs `hopf`, `simulate` and `stability` apart from files of the same names.

    Importing a submodule binds it to its package under its own name, and would hide the verb.
    """

    def __setattr__(self, name, value):
        if not (name in _HOMES and isinstance(value, types.ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
