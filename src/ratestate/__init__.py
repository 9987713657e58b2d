"""Spring-slider dynamics under rate-and-state friction.

>>> import ratestate as rs
>>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
>>> round(slider.V_c, 6)  # m/s
0.003162

Nothing heavy is loaded until it is used.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .dynamics.atlas import atlas
    from .dynamics.basin import escape
    from .dynamics.continuation.branch import continue_cycle
    from .dynamics.cycles.limit_cycle import limit_cycle, orbit
    from .dynamics.cycles.regimes import classify
    from .dynamics.hopf import bautin, hopf
    from .dynamics.simulation.simulate import simulate
    from .dynamics.stabilize import stabilize
    from .dynamics.steady_sliding import frequency_response, stability
    from .dynamics.verdict import verdict
    from .errors import (
        NotConverged,
        ParameterError,
        QuasiStaticInstability,
        RateStateError,
        SolverError,
    )
    from .friction.law import FrictionLaw
    from .interfaces.explorer import explore
    from .model.conversion import in_units
    from .model.loading import Loading
    from .model.parameters import logspace
    from .model.slider import SpringSlider
    from .model.user_laws import register
    from .records.fitting.by_law import fitted_slider
    from .records.fitting.fit import fit
    from .records.healing.healing import healing
    from .records.machine.machine_stiffness import machine_stiffness
    from .records.reading import read_lab
    from .records.stick_slip import events
    from .report import summary
    from .sweeps.sweep import sweep

__all__ = [
    "FrictionLaw",
    "Loading",
    "NotConverged",
    "ParameterError",
    "QuasiStaticInstability",
    "RateStateError",
    "SolverError",
    "SpringSlider",
    "atlas",
    "bautin",
    "classify",
    "continue_cycle",
    "escape",
    "events",
    "explore",
    "fit",
    "fitted_slider",
    "frequency_response",
    "healing",
    "hopf",
    "in_units",
    "limit_cycle",
    "logspace",
    "machine_stiffness",
    "orbit",
    "read_lab",
    "register",
    "simulate",
    "stability",
    "stabilize",
    "summary",
    "sweep",
    "verdict",
]

#: module -> the public names that it defines
_NAMES = {
    "dynamics.atlas": "atlas",
    "dynamics.basin": "escape",
    "dynamics.continuation.branch": "continue_cycle",
    "dynamics.cycles.limit_cycle": "limit_cycle orbit",
    "dynamics.cycles.regimes": "classify",
    "dynamics.hopf": "bautin hopf",
    "dynamics.simulation.simulate": "simulate",
    "dynamics.stabilize": "stabilize",
    "dynamics.steady_sliding": "frequency_response stability",
    "dynamics.verdict": "Verdict verdict",
    "errors": "CompilationError FitWarning NotConverged ParameterError QuasiStaticInstability"
    " RateStateError RecordWarning RunWarning SolverError StoreError",
    "friction.law": "FrictionLaw",
    "interfaces.explorer": "explore",
    "model.conversion": "in_units",
    "model.loading": "Loading",
    "model.parameters": "logspace",
    "model.slider": "SpringSlider",
    "model.user_laws": "register",
    "records.fitting.by_law": "fitted_slider",
    "records.fitting.fit": "fit",
    "records.healing.healing": "healing",
    "records.machine.machine_stiffness": "machine_stiffness",
    "records.reading": "read_lab",
    "records.stick_slip": "events",
    "report": "summary",
    "sweeps.sweep": "sweep",
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}
#: packages that are where they are documented
_PACKAGES = ("files", "laws", "paper", "plot")
#: module as it is documented -> where it is
_MODULES = {
    "backend": "engine.backend",
    "fitting": "records.fitting",
    "formulas": "friction.formulas",
    "lab": "records.reading",
    "quantities": "model.quantities",
    "quasi_static": "friction.quasi_static",
    "scenario": "interfaces.scenario",
    "stability": "friction.stability",
    "units": "model.units",
}


def __getattr__(name: str) -> Any:
    value: Any
    if name == "__version__":
        from importlib.metadata import version

        value = version("ratestate")
    elif name in _HOMES:
        value = getattr(import_module(f"ratestate.{_HOMES[name]}"), name)
    elif name in _PACKAGES:
        value = import_module(f"ratestate.{name}")
    elif name in _MODULES:
        value = import_module(f"ratestate.{_MODULES[name]}")
    else:
        raise AttributeError(f"module 'ratestate' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__():
    return [*__all__, "__version__"]


class _Documented(ModuleType):
    """A module by its documented path, loaded when something of it is used.

    It stands in ``sys.modules`` from the start, so that importing it binds nothing in the package:
    ``ratestate.stability`` stays the function.
    """

    def __getattr__(self, name):
        module = import_module(f"ratestate.{_MODULES[self.__name__.removeprefix('ratestate.')]}")
        return getattr(module, name)


for _name in _MODULES:
    sys.modules[f"ratestate.{_name}"] = _Documented(f"ratestate.{_name}")
