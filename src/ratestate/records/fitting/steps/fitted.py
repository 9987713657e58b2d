"""Windows that are to be fitted, and that have been."""

from typing import NamedTuple

import numpy as np
import xarray

from ...kit.noise import Noise
from ...load_point.stress_steps import VARIABLE, stress_range
from ...messages import fitting as sentences
from ..likelihood.noise_uncertainty import Inflation
from ..record import Record
from ..settings import Settings
from ..unknowns import Unknowns
from .windows import Window

#: parameters of the slider that are the machine's, not the law's
OF_MACHINE = ("K", "M", "lag")
#: distance from the end of a coordinate's range at which a parameter is at its bound
AT_BOUND = 1e-6


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
    responds: bool  # whether friction does, beyond noise

    @property
    def at_bound(self):
        """Names (list) of parameters that are at the end of their range."""
        room = np.minimum(self.point - self.unknowns.low, self.unknowns.high - self.point)
        return [n for n, r in zip(self.unknowns.names, room, strict=True) if r <= AT_BOUND]


class Fitted(NamedTuple):
    """A window with its fits."""

    task: Task
    laws: dict  # law -> `Separate`, or the message (str) why there is none
    is_stick_slip: bool = False  # which is why there is none

    def of(self, law):
        """The `Separate` of a law, or None."""
        separate = self.laws[law]
        return None if isinstance(separate, str) else separate

    @property
    def is_spoilt(self):
        """Whether normal stress varies under a step or hold of the load point."""
        of_stress = self.task.window.kind == "normal stress"
        return not of_stress and stress_range(self.task.data) > VARIABLE

    def usable(self, law):
        """The `Separate` of a law if all steps may be judged by it, or None.

        Not if its search has not converged, friction does not respond, a parameter is at its bound,
        or normal stress varies.
        """
        separate = self.of(law)
        if not separate or not (separate.converged and separate.responds):
            return None
        return None if separate.at_bound or self.is_spoilt else separate

    def remarks(self, law):
        """Sentences (list) on why all steps leave out one that is fitted under a law."""
        found = [sentences("each.stress_varies")] if self.is_spoilt else []
        if names := self.of(law).at_bound:
            found.append(sentences("each.at_bound", names=" and ".join(names)))
        return found


def shared_coordinates(unknowns, settings):
    """Coordinates (list of int) that the steps share: those of the law's parameters."""
    names = unknowns.names
    return [i for i, n in enumerate(names) if n in settings.free and n not in OF_MACHINE]
