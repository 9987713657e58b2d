"""Scenario files: what to do, as TOML with units, checked as a whole before anything runs.

::

    [slider]  # the parameters of SpringSlider
    a = 0.003
    b = 0.006
    Dc = "10 um"
    sigma = "2 MPa"
    K = "900 MPa/m"

    [sweep]
    verb = "limit_cycle"
    M = { from = "100 kg/m^2", to = "1e5 kg/m^2", n = 12, scale = "log" }
    V_lp = ["1 mm/s", 3.2e-3]
"""

from .files import Scenario, load

__all__ = ["Scenario", "load"]
