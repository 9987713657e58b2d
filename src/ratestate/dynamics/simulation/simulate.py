"""The function `simulate`: the motion of a slider under a load-point history."""

import dataclasses
import functools
import warnings
from typing import Any

import numpy as np
import xarray

from ...engine.model import FINISHED
from ...errors import RunWarning
from ...friction.composition import under_varying_stress
from ...machine import check_fits
from ...model.arrays import Batch
from ...model.initial_state import initial_values
from ...model.loading import Loading
from ...model.names import keywords_checked
from ...model.slider import SpringSlider, check_slider
from ...model.units import is_array, to_si
from ..progress import bar
from ..recorded_loading import record_loading
from ..refusals import refusal
from ..results import provenance
from .cases import failure
from .motion import blank_motion, motion_variables, move
from .settings import check_normal_stress, saved_times, solver_settings
from .undisturbed import undisturbed_warning

# Names of the result, which a dimension or coordinate of the sweep cannot have.
VARIABLES = (
    "V delta delta_lp V_load tau mu status steps energy_residual amplitude frequency cycles"
    " returns V_max V_min inertial_force mu_min reversal_margin outside_domain t"
).split()
# Memory of a case at each time: seven variables of the result, three of the engine's; two more for
# each state but the first.
BYTES, BYTES_OF_STATE = 80, 16


@keywords_checked
def simulate(
    slider,
    loading,
    t_end,
    *,
    V_start=None,
    initial=None,
    times=None,
    rtol=1e-6,
    method="auto",
):
    """March a slider, or a sweep of sliders, under a load-point history (eqs 1-4).

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    loading : Loading
        History of the load point; the run starts at its t = 0.
    t_end : float, str, pint.Quantity or DataArray
        End of the run [s], > 0.
    V_start : float, str, pint.Quantity or DataArray, optional
        The run starts in steady sliding at this speed [m/s], > 0; by default at the loading's
        first, which must then be > 0.
    initial : dict, optional
        Any of "V" [m/s], "theta" [s] and "tau" [Pa], which override those of the steady start.
        Where M = 0 two of them fix the third: V and theta, or V and tau, or theta and tau.
        With friction="regularized" V may be 0 or negative.
        Where K = inf V is the load point's speed, and theta or tau fixes the other.
    times : array_like or DataArray, optional
        Times to save [s], in increasing order, from 0 to t_end (the shortest, if they
        differ): 1-D, or a DataArray with the dimension ``time`` and those of the sweep.  By
        default the solver's own steps for one slider, with seven times more inside those of Taylor
        series, and the final state for a sweep.
    rtol : float
        Error allowed in a step, in tau/(a sigma), ln V and ln theta: 1e-13 to 0.1, by default
        1e-6.  If K = inf it is at most 1e-12.
    method : {"auto", "rodas5p"}
        Taylor series of order 12 where the motion is not stiff and the law's formulas are sums,
        products, quotients and exponentials of speed and state, and Rodas5P elsewhere; or Rodas5P
        alone.  The paper's own scheme is `ratestate.paper.im2017`.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions, then ``time``: ``V`` and ``V_load`` (slider and load point,
        [m/s]), ``theta`` [s], ``delta`` and ``delta_lp`` [m], ``tau`` [Pa] (the spring's),
        ``mu`` (eq. 1 for these V and theta; NaN where one of them is beyond double precision),
        and ``sigma`` [Pa] if the loading changes it; tau/sigma is then tau over this sigma.
        Per case: ``status`` (int8 with CF flags; 0 finished), ``steps``,
        ``energy_residual`` (load work less stored and dissipated energy, divided by the
        sum of their sizes),
        ``cycles`` (stress maxima after the first since the last jump in the loading),
        ``amplitude`` (max - min of tau/sigma, not counting the maximum at which it begins) and
        ``frequency`` [Hz] of the last period (0 if there is none or if its amplitude is below
        10 a rtol), ``returns`` (how many of those maxima make that period: 1, or more, up to 32,
        if unequal ones follow each other in a fixed order throughout the later half of the last
        64 and do not leave it; 0 if they do so in none: then amplitude is that of this half, and
        frequency how many there are in a second; 1 also if there are too few to tell, below 20 or
        so), ``V_max`` and ``V_min`` [m/s] of the run, ``inertial_force`` (its
        largest |M dV/dt|/sigma, without damping |tau/sigma - mu|; this and amplitude are over sigma
        at t = 0).  Without mass V_max may be inf: beyond double precision, and yet a motion that
        comes back.
        ``outside_domain`` (int8 with CF flags): whether the run leaves the domain of the friction
        law, since friction would have to push (``mu_min``, its smallest mu, is negative), or since
        the spring pulls back harder than friction can hold (``reversal_margin``, the smallest
        tau/sigma + mu, is; where sigma varies, of (tau + sigma mu)/sigma(0)).  Both smallest
        values are found between the solver's steps as well.
        With friction="regularized" slip then reverses, V_min is negative, and nothing is outside.
        delta_lp(0) = 0 and delta(0) = -tau(0)/K (0 where K = inf).

    Raises
    ------
    ParameterError
        An input that cannot be used.
    QuasiStaticInstability
        M = 0, and no quasi-static motion exists beyond some time before t_end.
    SolverError
        Any other run without an answer.  The attribute ``best`` of both errors is the run up to
        where it ended, at the solver's own steps.  In a sweep the motion of such cases is NaN,
        with their status.

    Warns
    -----
    RunWarning
        The run starts on steady sliding that is unstable, and nothing disturbs it: the load point's
        speed is constant, and neither V_start nor `initial` differs from steady sliding.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> run = rs.simulate(slider, rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s")), t_end=11)
    >>> run.sizes["time"] > 1000 and int(run.status) == 0
    True
    """
    settings = {"rtol": rtol, "method": method}
    start = {"V_start": V_start, "initial": initial}
    call = simulate_call(slider, loading, t_end, times=times, **start, **settings)
    call.check_fits()
    if text := undisturbed_warning([call]):
        warnings.warn(text, RunWarning, stacklevel=3)  # (past `keywords_checked`)
    with bar("simulate") as progress:
        return call.result(progress)


def simulate_call(slider, loading, t_end, *, V_start, initial, times, rtol, method):
    """`SimulateCall` with these arguments of `simulate`; ParameterError where one is wrong.

    Whether their dimensions fit together, and a start at rest, shows in its `batch`; whether
    initial values contradict each other, when it runs.
    """
    check_slider(slider)
    if not isinstance(loading, Loading):
        raise refusal("simulate.loading", loading=loading)
    rtol = solver_settings(rtol, method)
    t_end = to_si("t_end", t_end)
    V_start = None if V_start is None else to_si("V_start", V_start)
    initial = initial_values(initial, slider.friction_law)
    loading.covers(t_end)
    check_normal_stress(loading, slider, t_end)
    times = saved_times(times, t_end)
    return SimulateCall(slider, loading, t_end, V_start, initial, times, rtol, method)


@dataclasses.dataclass(frozen=True, eq=False)
class SimulateCall:
    """`simulate` with its arguments, checked and in SI."""

    slider: SpringSlider
    loading: Loading
    t_end: Any
    V_start: Any = None  # the loading's first speed
    initial: dict = dataclasses.field(default_factory=dict)  # as from `initial_values`
    times: Any = None
    rtol: float = 1e-6
    method: str = "auto"

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, t_end, V_start and what `initial` gives.

        ParameterError where dimensions or coordinates clash, or there is no V_start > 0.
        """
        start = self.loading.V_first if self.V_start is None else self.V_start
        if not np.all(np.greater(start, 0.0)):
            raise refusal("simulate.at_rest")
        values = {**self.slider.values, "t_end": self.t_end, "V_start": start, **self.initial}
        histories = {"V_lp": self.loading.V}
        if (stress := self.loading.normal_stress) is not None:
            own = {"sigma_amplitude": stress.amplitude, "sigma_period": stress.period}
            values = {"alpha": 0.0, **values, **own}
            histories |= {"sigma at first": stress.start, "sigma at last": stress.end}
        extra = {name: history for name, history in histories.items() if is_array(history)}
        extra |= {"time": self.times} if is_array(self.times) else {}
        return Batch(values, extra, reserved=self.names)

    @property
    def law(self):
        """The friction law as the engine needs it."""
        law = self.slider.friction_law
        return law if self.loading.normal_stress is None else under_varying_stress(law)

    @property
    def names(self):
        """Names of the result's variables."""
        more = () if self.loading.normal_stress is None else ("sigma",)
        return (*VARIABLES, *more, *self.slider.friction_law.states)

    def check_fits(self):
        """Raise ParameterError if the results take more memory than there is."""
        times = 1 if self.times is None else self.times.shape[-1]
        each = BYTES + BYTES_OF_STATE * (len(self.slider.friction_law.states) - 1)
        check_fits(
            each * self.batch.n * times,
            f"the results of {self.batch.n:,} cases at {times:,} times",
            "save fewer times, or sweep into a store: sweep(simulate, ..., store='x.zarr')",
        )

    def result(self, progress=None):
        """The Dataset; raises for a single case that failed."""
        motion = self.move(progress)
        if self.batch.is_single and (status := motion.status[0]) != FINISHED:
            t, best = motion.numbers["t"][0], self._up_to_failure(motion)
            raise failure("simulate", self.slider, status, t, best, self.loading)
        return self.dataset(self.variables(motion))

    def _up_to_failure(self, motion):
        """The run up to where it failed, as a Dataset; None where its own steps are too many."""
        call, status = dataclasses.replace(self, times=None), motion.status[0]
        motion = motion if self.times is None else call.move(None)  # no saved time is the failure's
        return call.dataset(call.variables(motion)) if motion.status[0] == status else None

    def run(self, progress=None):
        """The result's variables, name -> Variable in the dimensions of the sweep, then time.

        A case that fails raises nothing: it has its status.
        """
        return self.variables(self.move(progress))

    def blank(self):
        """The variables of `run` with no case solved: NaN, status NO_CONVERGENCE."""
        return self.variables(blank_motion(self.slider.friction_law, self.batch, self.times))

    def move(self, progress):
        """The `Motion` of all cases."""
        return move(self, progress)

    def variables(self, motion):
        """The variables of `run`, from this motion."""
        return motion_variables(self, motion)

    def dataset(self, variables):
        """These variables of all cases as a Dataset with coordinates, provenance and loading."""
        coords = self.batch.coordinates(self.names)
        if self.V_start is None:
            coords.pop("V_start", None)
        initial = {name.removesuffix("_initial"): v for name, v in self.initial.items()}
        values = {symbol: self.batch.values[symbol] for symbol in ("V_start", "t_end")}
        if self.times is not None:
            values["times"] = "as saved"  # else the solver's own steps, or the end
        settings = {"method": self.method, "rtol": self.rtol, "initial": initial}
        attributes = provenance("simulate", self.slider, **settings, **values)
        result = xarray.Dataset(variables, coords, attributes)
        if "t" in variables:
            result = result.set_coords("t")
        record_loading(result, self.loading)
        return result
