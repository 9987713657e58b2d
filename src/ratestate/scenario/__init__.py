"""Scenario files: a task as TOML with units, all of it checked before anything runs.

::

    [slider]  # the parameters of SpringSlider
    a = 0.003
    b = 0.006
    Dc = "10 um"
    sigma = "2 MPa"
    K = "900 MPa/m"

    [loading]
    V_lp = "0.1 mm/s"  # the speed at the start
    # in addition, at most one of these two:
    steps = [
        { t = "1 s", V_lp = "3.2 mm/s" },               # a step
        { t = "2 s", hold = "100 s" },                  # a rest, then the speed before it
        { t = "200 s", V_lp = "1 mm/s", ramp = "2 s" }, # a ramp, from t on
    ]
    sinusoid = { amplitude = "0.05 mm/s", period = "2 s" }  # or frequency; about V_lp
    # in place of all these, a recorded history: two columns of a file in the same folder,
    file = "record.csv"
    columns = ["time [s]", "V_lp [um/s]"]  # or their numbers
    units = ["s", "um/s"]                  # optional, in place of the units in the titles
    # or two lists
    t = [0, 1, 1, "5 s"]
    V_lp = ["1 um/s", "1 um/s", "3 um/s", 0]

    [run]  # for `simulate`: t_end and its other arguments
    t_end = "300 s"
    V_start = "1 um/s"
    initial = { theta = "10 s" }
    times = { from = "0 s", to = "300 s", n = 301 }
    rtol = 1e-6
    method = "rodas5p"
    function = "limit_cycle"  # in place of "simulate", with its arguments, such as rtol

    [sweep]  # replaces keys of the other tables; V_lp replaces the last speed of [loading]
    function = "limit_cycle"
    M = { from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }
    V_lp = ["1 mm/s", 3.2e-3]
    # "continue_cycle" follows one parameter, such as K = { from = "700 MPa/m", to = "500 MPa/m" }

    [output]  # relative to the current directory
    file = "out.nc"   # or .csv, .zarr
    plot = "out.png"  # or .pdf
"""

# Modules are imported when they are first used: the templates alone need none of the others.

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .as_python import python as python
    from .as_toml import toml as toml
    from .files import load as load
    from .files import loads as loads
    from .scenario import Output as Output
    from .scenario import Scenario as Scenario
    from .scenario import from_result as from_result
    from .scenario import run as run
    from .templates import TEMPLATES as TEMPLATES
    from .templates import template as template

#: module -> the public names that it defines
_NAMES = {
    "templates": "TEMPLATES template",
    "scenario": "Output Scenario from_result run",
    "files": "load loads",
    "as_python": "python",
    "as_toml": "toml",
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names.split()}
__all__ = [*_HOMES]  # noqa: PLE0604  (the table above)


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return __all__
