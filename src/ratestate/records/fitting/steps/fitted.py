"""Windows that are to be fitted, and that have been."""

from typing import NamedTuple

import numpy as np
import xarray

from ..likelihood.noise_uncertainty import Inflation
from ..noise import Noise
from ..record import Record
from ..settings import Settings
from ..unknowns import Unknowns
from .windows import Window

#: parameters of the slider that are the machine's, not the law's
OF_MACHINE = ("K", "M", "lag")


class Task(NamedTuple):
    """A window to be fitted."""

    window: Window
    data: xarray.Dataset  # its rows
    settings: Settings  # with the sliders from where the searches begin
    rows_per_sample: int  # of the record, which are averaged

    def with_sliders(self, sliders):
        """The `Task` with other sliders (list)."""
        return self._replace(settings=self.settings._replace(sliders=sliders))


class Separate(NamedTuple):
    """The fit of a window under one law."""

    result: xarray.Dataset  # of `datasets_of`
    record: Record
    unknowns: Unknowns
    point: np.ndarray  # (k,) coordinates of the best fit
    noise: Noise
    chi2: float  # of the whitened residuals
    inflation: Inflation  # of the coordinates that steps share
    converged: bool  # whether the search has
    is_misfit: bool  # whether the residuals are more than noise


class Fitted(NamedTuple):
    """A window with its fits."""

    task: Task
    laws: dict  # law -> `Separate`, or the message (str) why there is none
    is_stick_slip: bool = False  # which is why there is none

    def of(self, law):
        """The `Separate` of a law, or None."""
        separate = self.laws[law]
        return None if isinstance(separate, str) else separate

    def converged(self, law):
        """The `Separate` of a law if its search has converged, or None."""
        separate = self.of(law)
        return separate if separate and separate.converged else None


def shared_coordinates(unknowns, settings):
    """Coordinates (list of int) that the steps share: those of the law's parameters."""
    names = unknowns.names
    return [i for i, n in enumerate(names) if n in settings.free and n not in OF_MACHINE]
