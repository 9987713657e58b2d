"""What a fit is to do, checked."""

from typing import NamedTuple

from ...dynamics.refusals import check_one_length
from ...friction.laws import law_name
from ...model.slider import checked
from ...model.units import is_array
from .likelihood.uncertainty import ERRORS
from .noise import Noise, given_noise
from .refusals import refusal
from .unknowns import checked_free

#: setting -> what it may be, the default first
CHOICES: dict[str, tuple] = {
    "against": ("time", "displacement", "cycles"),
    "trend": ("slip", "time", None),
    "start": ("auto", "steady", "free"),
    "errors": ERRORS,
}


class Settings(NamedTuple):
    """The settings of `fit`."""

    free: tuple
    laws: list
    noise: Noise | None
    against: str
    trend: str | None
    start: str
    errors: str

    @property
    def recorded(self):
        """name -> the choice, as the result's attributes have it."""
        return {name: str(getattr(self, name)) for name in CHOICES}


def checked_settings(slider, *, free, law, noise, **choices):
    """The `Settings` of these arguments of `fit`.

    ParameterError: no slider, or many; what cannot be free; a law, noise or choice that is none;
    what a fit of cycles has no use for.
    """
    checked(slider)
    for symbol, value in slider.values.items():
        if is_array(value):
            raise refusal("settings.slider_array", symbol=symbol)
    free = checked_free(free, slider)
    for name, value in choices.items():
        if not (value is None or isinstance(value, str)) or value not in CHOICES[name]:
            listed = ", ".join(map(repr, CHOICES[name]))
            raise refusal("settings.unknown", name=name, value=value, choices=listed)
    noise = given_noise(noise)
    laws = [slider.law] if law is None else [law] if isinstance(law, str) else list(law)
    laws = [law_name(name) for name in laws]
    for name in laws:
        check_one_length("fit", name)
    if not laws or len(set(laws)) < len(laws):
        raise refusal("settings.laws", law=law)
    if choices["against"] == "cycles":
        names = ("trend", "start", "errors")
        changed = [name for name in names if choices[name] != CHOICES[name][0]]
        changed += [] if noise is None else ["noise"]
        if changed:
            raise refusal("settings.not_for_cycles", names=", ".join(changed))
    return Settings(free, laws, noise, **choices)
