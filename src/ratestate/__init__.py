"""Spring-slider dynamics under rate-and-state friction.

>>> import ratestate as rs
>>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
>>> round(slider.V_c, 6)  # m/s
0.003162

Nothing heavy is loaded until it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # for editors and type checkers, which do not run `__getattr__`
    from . import files as files
    from . import formulas as formulas
    from . import laws as laws
    from . import plot as plot
    from . import scenario as scenario
    from .dynamics.atlas import atlas as atlas
    from .dynamics.basin import escape as escape
    from .dynamics.continuation.branch import continue_cycle as continue_cycle
    from .dynamics.cycles.limit_cycle import limit_cycle as limit_cycle
    from .dynamics.cycles.limit_cycle import orbit as orbit
    from .dynamics.cycles.regimes import classify as classify
    from .dynamics.hopf import bautin as bautin
    from .dynamics.hopf import hopf as hopf
    from .dynamics.simulation.simulate import simulate as simulate
    from .dynamics.stabilize import stabilize as stabilize
    from .dynamics.steady_sliding import frequency_response as frequency_response
    from .dynamics.steady_sliding import stability as stability
    from .dynamics.verdict import Verdict as Verdict
    from .dynamics.verdict import verdict as verdict
    from .engine.backend import Stopped as Stopped
    from .engine.backend import use as use
    from .errors import CompilationError as CompilationError
    from .errors import FitWarning as FitWarning
    from .errors import MissingFileError as MissingFileError
    from .errors import NotConverged as NotConverged
    from .errors import ParameterError as ParameterError
    from .errors import QuasiStaticInstability as QuasiStaticInstability
    from .errors import RateStateError as RateStateError
    from .errors import RecordWarning as RecordWarning
    from .errors import RunWarning as RunWarning
    from .errors import SolverError as SolverError
    from .errors import StoreError as StoreError
    from .friction.law import FrictionLaw as FrictionLaw
    from .interfaces.explorer import explore as explore
    from .model.conversion import in_units as in_units
    from .model.loading import Loading as Loading
    from .model.parameters import linspace as linspace
    from .model.parameters import logspace as logspace
    from .model.quantities import QUANTITIES as QUANTITIES
    from .model.quantities import readable as readable
    from .model.slider import SpringSlider as SpringSlider
    from .model.units import to_si as to_si
    from .model.user_laws import register as register
    from .records.fitting.by_law import fitted_slider as fitted_slider
    from .records.fitting.fit import fit as fit
    from .records.fitting.posterior import log_likelihood as log_likelihood
    from .records.healing.healing import healing as healing
    from .records.load_point.segments import find_segments as find_segments
    from .records.machine.machine_stiffness import machine_stiffness as machine_stiffness
    from .records.reading.lab_format import describe_lab as describe_lab
    from .records.reading.read import read_lab as read_lab
    from .records.stick_slip.catalogue import events as events
    from .report.report import Report as Report
    from .report.summary import summary as summary
    from .sweeps.sweep import sweep as sweep

#: public packages and modules of this package
_PACKAGES = ("files", "formulas", "laws", "paper", "plot", "scenario")
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
    "engine.backend": "Stopped use",
    "errors": "CompilationError FitWarning MissingFileError NotConverged ParameterError"
    " QuasiStaticInstability RateStateError RecordWarning RunWarning SolverError StoreError",
    "friction.law": "FrictionLaw",
    "interfaces.explorer": "explore",
    "model.conversion": "in_units",
    "model.loading": "Loading",
    "model.parameters": "linspace logspace",
    "model.quantities": "QUANTITIES readable",
    "model.slider": "SpringSlider",
    "model.units": "to_si",
    "model.user_laws": "register",
    "records.fitting.by_law": "fitted_slider",
    "records.fitting.fit": "fit",
    "records.fitting.posterior": "log_likelihood",
    "records.healing.healing": "healing",
    "records.load_point.segments": "find_segments",
    "records.machine.machine_stiffness": "machine_stiffness",
    "records.reading.lab_format": "describe_lab",
    "records.reading.read": "read_lab",
    "records.stick_slip.catalogue": "events",
    "report.report": "Report",
    "report.summary": "summary",
    "sweeps.sweep": "sweep",
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}

__all__ = sorted([*_HOMES, *_PACKAGES])  # noqa: PLE0605  (the tables above)


def __getattr__(name: str) -> Any:
    value: Any
    if name == "__version__":
        from importlib.metadata import version

        value = version("ratestate")
    elif name in _HOMES:
        value = getattr(import_module(f"ratestate.{_HOMES[name]}"), name)
    elif name in _PACKAGES:
        value = import_module(f"ratestate.{name}")
    else:
        raise AttributeError(f"module 'ratestate' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__():
    return [*__all__, "__version__"]
