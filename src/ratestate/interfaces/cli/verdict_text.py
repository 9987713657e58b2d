"""The sentences above a report's tables: the verdict on a scenario with a single slider."""

import math
from pathlib import Path
from typing import NamedTuple

import xarray

from ...dynamics.results import parameter
from ...dynamics.simulation.settings import OTHER_START
from ...dynamics.verdict import Verdict, verdict
from ...dynamics.verdict_sentences import RUNAWAY
from ...engine.model import FINISHED
from ...engine.model import RUNAWAY as RAN_AWAY
from ...model.loading import Loading
from ...model.names import Sentences
from ...model.parameters import of_contact
from ...model.slider import SpringSlider
from ...scenario import Scenario

SENTENCES = Sentences(Path(__file__).with_suffix(".toml"))
# Relative difference of amplitudes beyond which a run has not reached the verdict's motion.
MAX_DIFFERENCE = 0.05
# Relative change of speed up to which a run has stayed on steady sliding.
UNCHANGED = 1e-6


class VerdictText(NamedTuple):
    """Text on a slider: the motion that it is about, the regime if it names one, and the text."""

    about: str
    regime: str | None
    text: str


def verdict_text(scenario: Scenario, result: xarray.Dataset) -> VerdictText | None:
    """The verdict on a single slider; None of a branch, a response, or a run with no last V > 0."""
    slider, settings = scenario.slider, scenario.settings
    match scenario.function:
        case "continue_cycle" | "frequency_response":
            return None
        case "limit_cycle":
            return _on_attractor(verdict(slider, settings["V_lp"], result))
        case "stability":
            return _on_attractor(verdict(slider, settings["V_lp"]))
    loading = settings["loading"]
    V_lp = speed_of_verdict(loading)
    if V_lp is None:
        return None
    attractor = verdict(loading.slider_at(math.inf, slider), V_lp)
    stress = _stress_text(loading, attractor.slider, slider)
    if loading.mean_speed is None and not loading.stress_oscillates:
        return _on_attractor(attractor, *_notes_on_end(attractor, result), stress=stress)
    # the motion under a speed or a normal stress that goes on varying is unknown
    name = "about.steady_sliding" if loading.mean_speed is None else "about.mean_speed"
    about = SENTENCES(name, V_lp=V_lp, stress=stress)
    return VerdictText(about, None, "\n".join(attractor.of_steady_sliding))


def _stress_text(loading: Loading, last: SpringSlider, first: SpringSlider) -> str:
    """Which normal stress the verdict is about; "" where it is the one of the beginning."""
    if last.sigma == first.sigma and not loading.stress_oscillates:
        return ""
    name = "about.mean_stress" if loading.stress_oscillates else "about.last_stress"
    return SENTENCES(name, sigma=of_contact("sigma", last.sigma, last.area))


def speed_of_verdict(loading: Loading) -> float | None:
    """The constant speed [m/s] that the verdict on a run under a loading is about.

    Of a loading with a shape, such as a sinusoid, its mean; None after a record, a hold, a ramp.
    """
    if loading.mean_speed is not None:
        return float(loading.mean_speed)
    V, rate = float(loading.V[-1]), float(loading.rate[-1])
    return None if loading.t_last < float("inf") or V == 0.0 or rate != 0.0 else V


def _on_attractor(verdict: Verdict, *more: str, stress: str = "") -> VerdictText:
    """The motion that the slider reaches under constant speed and normal stress."""
    about = SENTENCES("about.attractor", V_lp=verdict.V_lp, stress=stress)
    return VerdictText(about, verdict.regime, "\n".join([verdict.text, *more]))


def _notes_on_end(verdict: Verdict, result: xarray.Dataset) -> list[str]:
    """A note where a run did not end in the verdict's motion: another start, or too little time."""
    # a run's amplitude is over the slider's own sigma, the verdict's over the last
    amplitude = float(result.amplitude) * (parameter(result, "sigma") / verdict.slider.sigma)
    expected = verdict.amplitude
    if expected is None:
        is_far = verdict.regime == RUNAWAY and int(result.status) == FINISHED
    elif int(result.status) == RAN_AWAY:
        return [SENTENCES("run.runaway")]
    else:
        is_far = abs(amplitude - expected) > MAX_DIFFERENCE * max(amplitude, expected)
    if not is_far:
        return []
    if not verdict.stable and float(result.V_max) <= (1.0 + UNCHANGED) * float(result.V_min):
        start = OTHER_START * verdict.V_lp
        return [SENTENCES("run.undisturbed", V_start=start)]
    stress = "tau over the last normal stress" if "sigma" in result.data_vars else "tau/sigma"
    name = "run.cycle" if amplitude else "run.no_cycle"
    return [SENTENCES(name, amplitude=amplitude, stress=stress)]
