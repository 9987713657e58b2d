"""The settings of a fit, and their checks."""

from collections.abc import Iterable
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from ...dynamics.refusals import check_one_length
from ...model.slider import check_slider
from ...model.slider_parameters import resolve_law
from ...model.units import is_array
from ..kit.noise import Noise, given_noise
from ..messages import fitting as sentences
from .unknowns import DERIVED, LINEAR, PARAMETERS, checked_free, start_names

#: setting -> its choices, the default first
CHOICES: dict[str, tuple] = {
    "against": ("time", "displacement", "cycles"),
    "trend": ("slip", "time", None),
    "start": ("auto", "steady", "free"),
    "errors": ("auto", "covariance", "profile", "posterior"),
}


class Settings(NamedTuple):
    """The checked settings of `fit`."""

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


def checked_settings(slider, *, free, law, noise, per_step=False, loading=None, **choices):
    """Return the `Settings` for these arguments of `fit`."""
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
        for friction_law in [slider.friction_law for slider in sliders]:
            check_one_length("fit(..., against='cycles')", friction_law.name)
        names = ("trend", "start", "errors")
        changed = [name for name in names if choices[name] != CHOICES[name][0]]
        changed += [] if noise is None else ["noise"]
        if changed:
            raise sentences.refusal("settings.not_for_cycles", names=", ".join(changed))
    if not isinstance(per_step, bool | np.bool_):
        raise sentences.refusal("per_step.flag", value=per_step)
    if per_step and loading is not None:
        raise sentences.refusal("per_step.loading")
    if per_step and choices["against"] == "cycles":
        raise sentences.refusal("per_step.cycles")
    if choices["errors"] == "posterior" and find_spec("dynesty") is None:
        raise sentences.refusal("search.no_dynesty")
    return Settings(free, sliders, noise, **choices)


def check_choice(name, value, choices):
    """Raise a ParameterError unless a setting is one of the choices."""
    if not (value is None or isinstance(value, str)) or value not in choices:
        listed = ", ".join(map(repr, choices))
        raise sentences.refusal("settings.unknown", name=name, value=value, choices=listed)


def sliders_under(slider, law):
    """Return the slider under each law (list), with the parameters of that law."""
    is_one = law is None or isinstance(law, str | type) or not isinstance(law, Iterable)
    laws = [resolve_law(name) for name in ([slider.law if law is None else law] if is_one else law)]
    if not laws or len(set(laws)) < len(laws):
        raise sentences.refusal("settings.laws", law=law)
    for friction_law in laws:
        parameters, name = friction_law.parameters, friction_law.name
        if lacks := ", ".join(symbol for symbol in parameters if symbol not in slider.values):
            raise sentences.refusal("settings.lacks", law=name, names=lacks, of=slider.law)
        for symbol in parameters:
            if symbol in (*PARAMETERS, *LINEAR, *DERIVED, *start_names(friction_law)):
                raise sentences.refusal("settings.name_taken", law=name, symbol=symbol)
    return [slider.replace(law=friction_law.name) for friction_law in laws]
