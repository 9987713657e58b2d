"""The state of the page: what its entries describe."""

from typing import NamedTuple

from ....friction.composition import EXTRAS
from ....model.quantities import readable
from ....model.slider import SpringSlider
from .protocol import Segment

#: parameters that links need not have -> what they are then
NONE = {symbol: readable(symbol, 0.0) for symbol in (*EXTRAS, "alpha")}
#: entries of what there was before time 0, where it was another -> of what they are the value
BEFORE = {"V_from": "V_lp", "sigma_from": "sigma"}
#: all entries of an experiment, of which any may be absent
EXPERIMENT = (*BEFORE, "protocol", "kick")


class PageState(NamedTuple):
    """The state of the page: a slider and a speed, in the end of an experiment if there is one.

    That begins at time 0, with the motion that has settled before; see `entries` of `state_of`.
    Without one the start is steady sliding, see motion.START.
    """

    slider: SpringSlider
    V_lp: float
    V_from: float | None = None  # before time 0; None if that is V_lp
    sigma_from: float | None = None
    protocol: tuple[Segment, ...] = ()
    kick: float | None = None  # by which V is multiplied at time 0

    @property
    def values(self):
        """dict of the values of all fields, in SI."""
        of_all = {symbol: getattr(self.slider, symbol) for symbol in NONE}
        names = {"law": self.slider.law, "friction": self.slider.friction}
        experiment = {name: getattr(self, name) for name in EXPERIMENT}
        return of_all | self.slider.values | {"V_lp": self.V_lp} | experiment | names

    @property
    def before(self):
        """The `PageState` before time 0; None if there is no experiment."""
        if (self.V_from, self.sigma_from, self.protocol, self.kick) == (None, None, (), None):
            return None
        sigma = self.slider.sigma if self.sigma_from is None else self.sigma_from
        V_lp = self.V_lp if self.V_from is None else self.V_from
        return PageState(self.slider.replace(sigma=sigma), V_lp)

    @property
    def segments(self):
        """The `Segment`s of the protocol, each with its normal stress."""
        sigma, known = self.sigma_from or self.slider.sigma, []
        for segment in self.protocol:
            sigma = segment.sigma or sigma
            known.append(segment._replace(sigma=sigma))
        return known

    @property
    def sigma_varies(self):
        """Whether the normal stress changes."""
        first = self.sigma_from or self.slider.sigma
        return any(x != first for x in (*(s.sigma for s in self.segments), self.slider.sigma))
