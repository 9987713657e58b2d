"""Pictures of results: functions of (Dataset, ax), and `figure`, a whole figure of any result.

>>> import ratestate as rs
>>> from matplotlib.figure import Figure
>>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", M=3000, K="900 MPa/m")
>>> run = rs.simulate(slider, rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s")), t_end=1.2)
>>> black, red = trace(run, Figure().subplots())

Parameters that a picture needs, such as the normal stress for tau/sigma, are read from the
attributes of the result.
"""

from ..dynamics.results import parameter
from .bifurcation import branch
from .figures import figure
from .figures.fits import fit
from .figures.overview import overview
from .labels import AMPLITUDE, BLUE, GRAY, LAWS, RED, STRESS, label, prefixed, value_text
from .layout import save
from .maps import atlas, contours, transition
from .motion import amplitudes, phase, trace
from .runs import since

__all__ = [
    "AMPLITUDE",
    "BLUE",
    "GRAY",
    "LAWS",
    "RED",
    "STRESS",
    "amplitudes",
    "atlas",
    "branch",
    "contours",
    "figure",
    "fit",
    "label",
    "overview",
    "parameter",
    "phase",
    "prefixed",
    "save",
    "since",
    "trace",
    "transition",
    "value_text",
]


def __dir__():
    return __all__
