"""What a fit is to do, checked."""

from collections.abc import Iterable
from typing import NamedTuple

from ...dynamics.refusals import check_one_length
from ...model.slider import check_slider, resolve_law
from ...model.units import is_array
from ..kit.noise import Noise, given_noise
from ..messages import fitting as sentences
from .unknowns import LINEAR, PARAMETERS, SUMS, checked_free, starts_of

#: setting -> what it may be, the default first
CHOICES: dict[str, tuple] = {
    "against": ("time", "displacement", "cycles"),
    "trend": ("slip", "time", None),
    "start": ("auto", "steady", "free"),
    "errors": ("auto", "covariance", "profile", "posterior"),
}


class Settings(NamedTuple):
    """The settings of `fit`."""

    free: tuple
    sliders: list  # one for each law, in the order of the laws
    noise: Noise | None
    against: str
    trend: str | None
    start: str
    errors: str

    @property
    def laws(self):
        """Names of the laws."""
        return [slider.law for slider in self.sliders]

    @property
    def recorded(self):
        """name -> the choice, as the result's attributes have it."""
        return {name: str(getattr(self, name)) for name in CHOICES}


def checked_settings(slider, *, free, law, noise, each=None, loading=None, **choices):
    """The `Settings` of these arguments of `fit`; each="step" takes no loading, and no cycles.

    ParameterError: no slider, or many; what cannot be free; a law, noise or choice that is none; a
    law with parameters that the slider does not have; what a fit of cycles has no use for.
    """
    check_slider(slider)
    for symbol, value in slider.values.items():
        if is_array(value):
            raise sentences.refusal("settings.slider_array", symbol=symbol)
    for name, value in choices.items():
        check_choice(name, value, CHOICES[name])
    noise = given_noise(noise)
    sliders = sliders_under(slider, law)
    free = checked_free(free, sliders)
    if choices["against"] == "cycles":
        for one in sliders:
            check_one_length("fit(..., against='cycles')", one.friction_law.name)
        names = ("trend", "start", "errors")
        changed = [name for name in names if choices[name] != CHOICES[name][0]]
        changed += [] if noise is None else ["noise"]
        if changed:
            raise sentences.refusal("settings.not_for_cycles", names=", ".join(changed))
    check_choice("each", each, (None, "step"))
    if each is not None and loading is not None:
        raise sentences.refusal("each.loading")
    if each is not None and choices["against"] == "cycles":
        raise sentences.refusal("each.cycles")
    return Settings(free, sliders, noise, **choices)


def check_choice(name, value, choices):
    """Raise ParameterError unless a setting is one of these texts, or the None among them."""
    if not (value is None or isinstance(value, str)) or value not in choices:
        listed = ", ".join(map(repr, choices))
        raise sentences.refusal("settings.unknown", name=name, value=value, choices=listed)


def sliders_under(slider, law):
    """The slider under each law that is to be fitted (list), with the parameters of that law.

    ParameterError for a law that is none, for the same twice, and for one with parameters that the
    slider does not have, or that are called as what a fit has of its own.
    """
    one = law is None or isinstance(law, str | type) or not isinstance(law, Iterable)
    laws = [resolve_law(name) for name in ([slider.law if law is None else law] if one else law)]
    if not laws or len(set(laws)) < len(laws):
        raise sentences.refusal("settings.laws", law=law)
    for known in laws:
        names = ", ".join(symbol for symbol in known.parameters if symbol not in slider.values)
        if names:
            raise sentences.refusal("settings.lacks", law=known.name, names=names, of=slider.law)
        for symbol in known.parameters:
            if symbol in (*PARAMETERS, *LINEAR, *SUMS, *starts_of(known)):
                raise sentences.refusal("settings.name_taken", law=known.name, symbol=symbol)
    return [slider.replace(law=known.name) for known in laws]
