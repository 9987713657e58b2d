"""The verdict on a slider at a speed: its regime, numbers, and sentences."""

import dataclasses
import html
from typing import Any

import numpy as np

from ..engine.model import STEADY_SLIDING
from ..errors import NotConverged, QuasiStaticInstability, SolverError
from ..model.conversion import in_si
from ..model.parameters import force, of_contact
from ..model.quantities import QUANTITIES, readable
from ..model.slider import SpringSlider, check_slider
from ..model.units import is_array, to_si
from .continuation.coexistence import folds
from .cycles.limit_cycle import limit_cycle
from .cycles.regimes import UNKNOWN, regimes_of
from .refusals import refusal
from .steady_sliding import stability_call
from .verdict_sentences import CONDITIONAL, RUNAWAY, of_steady_sliding, on_edge, sentences

# K/K_c up to which a fold is sought; branches that are known fold below 1.016, for any b/a.
FOLDS_BELOW = 1.02


@dataclasses.dataclass(frozen=True, kw_only=True)
class Verdict:
    """The regime, numbers and sentences for a slider driven at V_lp, from `verdict`.

    Attributes
    ----------
    slider : SpringSlider
    V_lp : float
        Load-point velocity [m/s].
    regime : str
        The motion reached from steady sliding at a tenth of V_lp: "steady", "slow stick-slip",
        "stick-slip" or "quasi-harmonic" (see `ratestate.classify`).  If M = 0, it may also be
        "runaway": the speed grows without bound in a finite time.  It is "conditionally stable" if
        the motion from this start runs away, but small disturbances of steady sliding decay.  It is
        "unknown" if the search failed.
    stable : bool
        Whether steady sliding is stable: K > K_c.
    K_c, K_c_qs : float
        Critical stiffness with inertia (eq. 6) and without [Pa/m]; 0 if b = a, negative if b < a.
    V_c, V_c_upper : float
        Critical velocity [m/s] (eq. 10), and the speed above which sliding is stable again.  V_c is
        0 if sliding is unstable at every speed, and inf if it is stable at every speed.  V_c_upper
        is inf if it does not exist.
    eta : float
        Dynamic instability coefficient [1] (eq. 7).
    f_n : float
        Natural frequency [Hz]; inf if M = 0 or K = inf.
    growth_rate, omega : float
        Growth rate [1/s] and frequency [rad/s] of the least stable disturbance of steady sliding.
        The growth rate is negative if it decays, and omega is 0 if it does not oscillate.
    period, frequency, amplitude, V_max, V_min : float or None
        Measures of the limit cycle [s, Hz, 1, m/s, m/s], or None if there is no cycle.  But in
        steady sliding amplitude is 0 and V_max = V_min = V_lp.
    returns : int or None
        Stress maxima in a period; None without a cycle.
    mu_min, reversal_margin : float or None
        Smallest mu, and smallest tau/sigma + mu, of the motion reached.  If one is negative, the
        motion leaves the domain of the friction law.  None if the motion is not known, or runs
        away.
    multiplier : complex or None
        Largest Floquet multiplier except the trivial 1: the factor by which a disturbance changes
        in a cycle.  None without a cycle.
    K_fold : float or None
        Stiffness [Pa/m] up to which a limit cycle coexists with stable sliding; None if no fold is
        found, if sliding is unstable, or if K >= 1.02 K_c.
    sentences : tuple of str
        The verdict in words, a sentence each.  The first one names the regime.
    """

    slider: SpringSlider
    V_lp: float
    regime: str
    stable: bool
    K_c: float
    K_c_qs: float
    V_c: float
    V_c_upper: float
    eta: float
    f_n: float
    growth_rate: float
    omega: float
    period: float | None = None
    frequency: float | None = None
    amplitude: float | None = None
    V_max: float | None = None
    V_min: float | None = None
    returns: int | None = None
    mu_min: float | None = None
    reversal_margin: float | None = None
    multiplier: complex | None = None
    K_fold: float | None = None
    sentences: tuple[str, ...] = ()

    def _repr_html_(self):
        """Return the sentences and a table of the numbers, as a notebook shows them."""
        values = {name: getattr(self, name) for name in self.__dataclass_fields__}
        rows = "".join(
            f"<tr><td>{name}</td><td>{readable(*of_contact(name, x, self.slider.area))}</td>"
            f"<td style='text-align: left'>{QUANTITIES[name].long_name}</td></tr>"
            for name, x in values.items()
            if name in QUANTITIES and isinstance(x, float)
        )
        return f"<p>{'<br>'.join(map(html.escape, self.sentences))}</p><table>{rows}</table>"

    @property
    def fade(self):
        """Number of cycles in which a small disturbance falls to a tenth.

        It is inf if the disturbance grows, and None without a cycle.
        """
        if self.multiplier is None:
            return None
        size = abs(self.multiplier)
        if size >= 1.0:
            return np.inf
        return float(np.log(0.1) / np.log(size)) if size > 0.0 else 0.0

    @property
    def force_amplitude(self):
        """Peak-to-peak force [N] of the motion reached; None if it or the area is not known."""
        if self.amplitude is None or not self.slider.has_area:
            return None
        return force(self.amplitude * self.slider.sigma, self.slider.area)

    @property
    def on_edge(self):
        """Whether K = K_c > 0 to 8 digits: the text then does not say if sliding is stable."""
        return on_edge(self.slider.K, self.K_c)

    @property
    def of_steady_sliding(self):
        """Sentences on steady sliding alone (tuple of str), which hold for any motion."""
        return of_steady_sliding(self)

    @property
    def text(self):
        """The sentences, one a line."""
        return "\n".join(self.sentences)


def verdict(slider, V_lp, cycle=None):
    """Find what a slider does when driven at V_lp: its regime, numbers and sentences.

    Parameters
    ----------
    slider : SpringSlider
        One slider, not a sweep.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], > 0.
    cycle : xarray.Dataset or SolverError, optional
        What `limit_cycle` returned or raised for this slider and speed, if it was called before.

    Returns
    -------
    Verdict
        If the search for a cycle fails, ``regime`` is "unknown", and ``sentences`` say why.

    Raises
    ------
    ParameterError
        If an argument cannot be used.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> answer = verdict(slider, "3.2 mm/s")
    >>> answer.regime, answer.sentences[0].partition(":")[0]
    ('quasi-harmonic', 'Quasi-harmonic vibration at 50.59 Hz')
    """
    V_lp = to_si("V_lp", V_lp)
    if is_array(V_lp) or any(map(is_array, check_slider(slider).values.values())):
        raise refusal("verdict.of_sweep", slider=slider)
    if cycle is None:
        try:
            cycle = limit_cycle(slider, V_lp)
        except SolverError as error:
            cycle = error
    elif not (isinstance(cycle, SolverError) or _is_one_cycle(cycle)):
        raise refusal("verdict.cycle")
    cycle = in_si(cycle)
    steady = stability_call(slider, V_lp).run()
    of_sliding = "K_c K_c_qs V_c V_c_upper eta f_n growth_rate omega".split()
    values: dict[str, Any] = {name: float(steady[name].values) for name in of_sliding}
    values["stable"] = bool(steady["stable"].values)
    reason = ""
    if isinstance(cycle, QuasiStaticInstability):
        small = values["stable"] and not on_edge(slider.K, values["K_c"])
        values["regime"] = CONDITIONAL if small else RUNAWAY
    elif isinstance(cycle, SolverError):
        values["regime"] = UNKNOWN
        reason = "" if isinstance(cycle, NotConverged) else str(cycle).partition("\n")[0]
    else:
        numbers = {name: variable.values for name, variable in cycle.variables.items()}
        values["regime"] = str(regimes_of(numbers, slider.damping, slider.sigma))
        names = ["amplitude", "V_max", "V_min", "mu_min", "reversal_margin"]
        if int(numbers["status"]) != STEADY_SLIDING:
            names += ["period", "frequency"]
            values["multiplier"] = complex(numbers["multipliers"][0])
            values["returns"] = int(numbers["returns"])
        values |= {name: float(numbers[name]) for name in names}
    near = values["stable"] and 0.0 < slider.K < FOLDS_BELOW * values["K_c"]
    if near and slider.friction_law.one_length:
        kappa = float(folds(slider.law, slider.b / slider.a, [values["eta"]]).kappa[0])
        if np.isfinite(kappa):
            values["K_fold"] = kappa * slider.a * slider.sigma / slider.Dc
    answer = Verdict(slider=slider, V_lp=V_lp, **values)
    return dataclasses.replace(answer, sentences=sentences(answer, reason))


def _is_one_cycle(result):
    """Return whether this is a result of `limit_cycle` for one slider and speed."""
    title = getattr(result, "attrs", {}).get("title")
    return title == "ratestate limit_cycle" and "status" in result and result.status.ndim == 0
