"""The verdict on a slider at a speed: its regime, numbers, and sentences."""

import dataclasses
from typing import Any

import numpy as np
import xarray

from ..engine.model import STEADY_SLIDING
from ..errors import NotConverged, ParameterError, QuasiStaticInstability, SolverError
from ..model.slider import SpringSlider, checked
from ..model.units import is_array, to_si
from .continuation.folds import folds
from .cycles.limit_cycle import limit_cycle
from .cycles.regimes import UNKNOWN, classify
from .steady_sliding import stability
from .wording import CONDITIONAL, RUNAWAY, of_steady_sliding, on_edge, sentences

# K/K_c up to which a fold is sought; the aging law's branches fold below 1.016, for any b/a.
STRIP = 1.02


@dataclasses.dataclass(frozen=True, kw_only=True)
class Verdict:
    """What a slider does when driven at V_lp; made by `verdict`.

    Attributes
    ----------
    slider : SpringSlider
    V_lp : float
        Load-point velocity [m/s].
    regime : str
        "steady", "slow stick-slip", "stick-slip" or "quasi-harmonic" (see
        `ratestate.regimes.classify`): what is reached from steady sliding at a tenth of the speed.
        Without mass (M = 0) also "runaway": no motion beyond some time; and "conditionally
        stable" where that start runs away but small disturbances of steady sliding die.
        "unknown" where the search failed, as the text says.
    stable : bool
        Whether steady sliding is: K > K_c.
    K_c, K_c_qs : float
        Critical stiffness with inertia (eq. 6) and without [Pa/m]; negative where b < a.
    V_c : float
        Critical velocity [m/s] (eq. 10): 0 if always unstable, inf if never.
    eta : float
        Dynamic instability coefficient [1] (eq. 7).
    f_n : float
        Natural frequency [Hz]; inf if none.
    growth_rate, omega : float
        Of the least stable disturbance of steady sliding [1/s], [rad/s].
    period, frequency, amplitude, V_max, V_min : float or None
        Of the limit cycle [s, Hz, 1, m/s, m/s]: None without one, amplitude 0 in steady sliding.
    returns : int or None
        Stress maxima in a period; None without a cycle.
    mu_min, reversal_margin : float or None
        Smallest mu and tau/sigma + mu of the motion reached: below 0 it leaves the domain of the
        friction law (see `ratestate.dynamics.simulation.domain`).
    multiplier : complex or None
        Largest Floquet multiplier beside 1: the factor by which a disturbance changes in a cycle.
    K_fold : float or None
        Stiffness [Pa/m] up to which a limit cycle coexists with stable sliding, where there
        is a fold.
    sentences : tuple of str
        All this as text, the regime first.
    """

    slider: SpringSlider
    V_lp: float
    regime: str
    stable: bool
    K_c: float
    K_c_qs: float
    V_c: float
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

    @property
    def fade(self):
        """Cycles in which a small disturbance of the cycle falls to a tenth; None without one."""
        return None if self.multiplier is None else _tenth(abs(self.multiplier))

    @property
    def on_edge(self):
        """Whether K = K_c to 8 digits: then ``stable`` is a matter of rounding."""
        return on_edge(self.slider.K, self.K_c)

    @property
    def of_steady_sliding(self):
        """Sentences on steady sliding alone, which hold for any motion."""
        return tuple(of_steady_sliding(self))

    @property
    def text(self):
        """The sentences, a line each."""
        return "\n".join(self.sentences)


def verdict(slider, V_lp):
    """What a slider does when driven at V_lp: its regime, the numbers behind it, and words.

    Parameters
    ----------
    slider : SpringSlider
        One slider, no sweep.
    V_lp : float, str or pint.Quantity
        Load-point velocity [m/s], > 0.

    Returns
    -------
    Verdict
        Also where the search for a cycle fails: then `sentences` say so.

    Raises
    ------
    ParameterError
        An input that cannot be used.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> answer = verdict(slider, "3.2 mm/s")
    >>> answer.regime, answer.sentences[0].partition(":")[0]
    ('quasi-harmonic', 'Quasi-harmonic vibration at 50.59 Hz')
    """
    V_lp = to_si("V_lp", V_lp)
    if is_array(V_lp) or any(map(is_array, checked(slider).values.values())):
        raise ParameterError(f"{slider!r} or V_lp is a sweep; verdict wants one slider and speed")
    try:
        cycle: xarray.Dataset | SolverError = limit_cycle(slider, V_lp)
    except SolverError as error:
        cycle = error
    return verdict_of_cycle(slider, V_lp, cycle)


def verdict_of_cycle(slider, V_lp, cycle):
    """`Verdict`, given the result of `limit_cycle` or the SolverError that it raised."""
    steady = stability(slider, V_lp)
    names = ("K_c", "K_c_qs", "V_c", "eta", "f_n", "growth_rate", "omega")
    values: dict[str, Any] = {name: float(steady[name]) for name in names}
    values["stable"] = bool(steady.stable)
    values["regime"] = UNKNOWN
    if not isinstance(cycle, SolverError):
        values["regime"] = str(classify(cycle).regime.values)
        values["amplitude"] = float(cycle.amplitude)
        for name in ("V_max", "V_min", "mu_min", "reversal_margin"):
            values[name] = float(cycle[name])
        if int(cycle.status) != STEADY_SLIDING:
            values["period"], values["frequency"] = float(cycle.period), float(cycle.frequency)
            values["multiplier"] = complex(cycle.multipliers[0])
            values["returns"] = int(cycle.returns)
    if values["stable"] and 0.0 < slider.K < STRIP * values["K_c"]:
        values["K_fold"] = _fold(slider, values["eta"])
    answer = Verdict(slider=slider, V_lp=V_lp, **values)
    if isinstance(cycle, QuasiStaticInstability):
        small = answer.stable and not answer.on_edge
        answer = dataclasses.replace(answer, regime=CONDITIONAL if small else RUNAWAY)
    failed = isinstance(cycle, SolverError) and not isinstance(cycle, NotConverged)
    reason = str(cycle).partition("\n")[0] if failed else ""
    return dataclasses.replace(answer, sentences=tuple(sentences(answer, reason)))


def _fold(slider, eta):
    """Stiffness [Pa/m] at which the branch of cycles folds back; None if it does not."""
    kappa = float(folds(slider.law, slider.b / slider.a, [eta]).kappa[0])
    return kappa * slider.a * slider.sigma / slider.Dc if np.isfinite(kappa) else None


def _tenth(multiplier):
    """Cycles in which this multiplier takes a disturbance to a tenth."""
    if multiplier >= 1.0:
        return np.inf
    return float(np.log(0.1) / np.log(multiplier)) if multiplier > 0.0 else 0.0
