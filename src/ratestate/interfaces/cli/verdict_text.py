"""The verdict on a scenario with a single slider, as text for the report."""

from typing import TYPE_CHECKING, NamedTuple

from ...model.quantities import readable

if TYPE_CHECKING:
    import xarray

    from ...dynamics.verdict import Verdict
    from ...errors import SolverError
    from ..scenario import Scenario

# Relative difference of amplitudes beyond which a run has not reached the verdict's motion.
FAR = 0.05


class VerdictText(NamedTuple):
    """Text on a slider: the motion that it is about, the regime if it names one, and the text."""

    about: str
    regime: str | None
    text: str


def verdict_text(scenario: "Scenario", result: "xarray.Dataset") -> VerdictText | None:
    """The verdict on a single slider, or None where there is none, as for a branch."""
    from ...dynamics.verdict import verdict, verdict_of_cycle

    slider, settings = scenario.slider, scenario.settings
    match scenario.verb:
        case "continue_cycle":
            return None
        case "limit_cycle":
            return _on_attractor(verdict_of_cycle(slider, settings["V_lp"], result))
        case "stability":
            return _on_attractor(verdict(slider, settings["V_lp"]))
    loading = settings["loading"]
    if loading.sine is not None:
        return _on_steady_sliding(verdict(slider, loading.sine.V_lp))
    V, rate = float(loading.V[-1]), float(loading.rate[-1])
    if loading.t_last < float("inf") or V == 0.0 or rate != 0.0:
        return None  # a record, a hold, a ramp
    attractor = verdict(slider, V)
    text = _on_attractor(attractor)
    lines = filter(None, (text.text, _not_reached(attractor, result)))
    return text._replace(text="\n".join(lines))


def _on_attractor(verdict: "Verdict") -> VerdictText:
    """The motion that the slider reaches under constant speed."""
    speed = readable("V_lp", verdict.V_lp)
    about = f"Driven steadily at V_lp = {speed}, from a tenth of that speed on"
    return VerdictText(about, verdict.regime, verdict.text)


def _on_steady_sliding(verdict: "Verdict") -> VerdictText:
    """Steady sliding only, at the mean of a varying speed, under which the motion is unknown."""
    about = f"Steady sliding at the mean speed, V_lp = {readable('V_lp', verdict.V_lp)}"
    return VerdictText(about, None, "\n".join(verdict.of_steady_sliding))


def _not_reached(verdict: "Verdict", result: "xarray.Dataset") -> str:
    """A note where a run did not end in the verdict's motion: another start, or too little time.

    A run that came to its end did not run away.
    """
    from ...dynamics.wording import RUNAWAY

    amplitude, expected = float(result.amplitude), verdict.amplitude
    if expected is None:
        far = verdict.regime == RUNAWAY
    else:
        far = abs(amplitude - expected) > FAR * max(amplitude, expected)
    if not far:
        return ""
    last = (
        f"its last cycle swings tau/sigma by {amplitude:.4g}"
        if amplitude
        else "it ends in no cycle"
    )
    return f"This run is not there, or not yet: {last}."


def no_cycle_message(scenario: "Scenario", error: "SolverError") -> str:
    """The message where no cycle is found: the verdict on the slider, and its parameters."""
    from ...dynamics.verdict import verdict_of_cycle

    verdict = verdict_of_cycle(scenario.slider, scenario.settings["V_lp"], error)
    return f"no cycle is found.\n{verdict.text}\n{scenario.slider!r}"
