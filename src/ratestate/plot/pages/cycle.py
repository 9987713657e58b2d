"""The page of a limit cycle: one turn of it, with its numbers."""

from ...dynamics.attributes import number
from ...dynamics.cycles.orbit import orbit
from ...dynamics.cycles.regimes import classify
from ...dynamics.results import parameter
from ...dynamics.steady_sliding import stability
from ...engine.model import STEADY_SLIDING
from ...model.slider import SpringSlider
from ..labels import value_text
from ..laws import LAWS
from ..layout import styled
from .run import motion
from .stability import stability_page

SYMBOLS = "a b Dc sigma K M mu0 V0 law".split()


@styled
def cycle_page(cycle):
    """Page of one slider's cycle; where it slides steadily, that of `stability`."""
    slider = SpringSlider(**{symbol: parameter(cycle, symbol) for symbol in SYMBOLS})
    V_lp = float(cycle.V_lp)
    if int(cycle.status) == STEADY_SLIDING:
        return stability_page(stability(slider, V_lp))
    kind = str(classify(cycle).regime.values)
    title = (
        f"Limit cycle ({kind}) at {value_text('V_lp', V_lp)}, {LAWS[slider.law]}: "
        f"{value_text('period', float(cycle.period))}, "
        f"amplitude {float(cycle.amplitude):.4g}"
    )
    return motion(orbit(slider, V_lp, rtol=number(cycle, "rtol")), title)
