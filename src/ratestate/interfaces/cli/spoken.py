"""What is said in words of a scenario with a single slider, and of what that holds."""

from typing import TYPE_CHECKING, NamedTuple

from ...model.quantities import readable

if TYPE_CHECKING:
    import xarray

    from ...dynamics.verdict import Verdict
    from ...errors import SolverError
    from ..scenario import Scenario

# Relative difference of amplitudes beyond which a run is not where the verdict says.
FAR = 0.05


class Spoken(NamedTuple):
    """Words on a slider: of what they hold, the regime if they tell one, and the text."""

    about: str
    regime: str | None
    text: str


def spoken(asked: "Scenario", result: "xarray.Dataset") -> Spoken | None:
    """Words on a single slider, or None where nothing is sure."""
    from ...dynamics.verdict import verdict, verdict_of_cycle

    if asked.verb == "continue_cycle":
        return None
    if asked.verb == "limit_cycle":
        return _settled(verdict_of_cycle(asked.slider, asked.settings["V_lp"], result))
    if asked.verb == "stability":
        return _settled(verdict(asked.slider, asked.settings["V_lp"]))
    loading = asked.settings["loading"]
    if loading.sine is not None:
        return _mean(verdict(asked.slider, loading.sine.V_lp))
    V, rate = float(loading.V[-1]), float(loading.rate[-1])
    if loading.t_last < float("inf") or V == 0.0 or rate != 0.0:
        return None  # a record, a hold, a ramp
    found = verdict(asked.slider, V)
    said = _settled(found)
    return said._replace(text="\n".join(filter(None, (said.text, _elsewhere(found, result)))))


def _settled(found: "Verdict") -> Spoken:
    """What the slider settles into."""
    about = (
        f"Driven steadily at V_lp = {readable('V_lp', found.V_lp)}, from a tenth of that speed on"
    )
    return Spoken(about, found.regime, found.text)


def _mean(found: "Verdict") -> Spoken:
    """On steady sliding alone: of the motion about it under a speed that varies nothing is said."""
    about = f"Steady sliding at the mean speed, V_lp = {readable('V_lp', found.V_lp)}"
    return Spoken(about, None, "\n".join(found.of_steady_sliding))


def _elsewhere(found: "Verdict", result: "xarray.Dataset") -> str:
    """Where a run ended that is not where the verdict says: it had another start, or little time.

    A run that came to its end is none that ran away.
    """
    from ...dynamics.wording import RUNAWAY

    swing, settled = float(result.amplitude), found.amplitude
    if settled is None:
        far = found.regime == RUNAWAY
    else:
        far = abs(swing - settled) > FAR * max(swing, settled)
    if not far:
        return ""
    last = f"its last cycle swings tau/sigma by {swing:.4g}" if swing else "it ends in no cycle"
    return f"This run is not there, or not yet: {last}."


def instead(asked: "Scenario", error: "SolverError") -> str:
    """The message where no cycle is found: what there is."""
    from ...dynamics.verdict import verdict_of_cycle

    found = verdict_of_cycle(asked.slider, asked.settings["V_lp"], error)
    return f"no cycle is found.\n{found.text}\n{asked.slider!r}"
