"""The function `simulate`: the motion of a slider under a load-point history."""

import dataclasses
import functools
import warnings
from typing import Any

import numpy as np

from ...engine.model import FINISHED
from ...errors import RunWarning
from ...friction.composition import under_varying_stress
from ...machine import check_fits
from ...model.arrays import Batch
from ...model.initial_state import initial_values
from ...model.loading import Loading, as_loading
from ...model.names import keywords_checked
from ...model.slider import check_slider
from ...model.units import is_array, to_si
from ..progress import bar
from ..refusals import refusal
from ..results import CheckedCall
from .engine_cases import failure
from .run_batch import blank_motion, motion_variables, move
from .settings import check_normal_stress, saved_times, solver_settings, undisturbed_warning

# Names of the result, which a dimension or coordinate of the sweep cannot have.
VARIABLES = (
    "V delta delta_lp V_load tau mu status steps energy_residual amplitude stress_drop frequency"
    " cycles returns V_max V_min inertial_force mu_min reversal_margin outside_domain t"
).split()
# Memory of a case at each time: seven variables of the result, three of the engine; two more for
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
    """Compute the motion of a slider, or of a sweep, under a load-point history (eqs 1-4).

    Parameters
    ----------
    slider : SpringSlider
        Parameters that are named DataArrays make a sweep.
    loading : Loading, or float, str, pint.Quantity or DataArray
        History of the load point, or its constant speed [m/s].  The run starts at t = 0.
    t_end : float, str, pint.Quantity or DataArray
        End of the run [s], > 0.
    V_start : float, str, pint.Quantity or DataArray, optional
        The run starts in steady sliding at this speed [m/s], > 0.  The default is the loading's
        first speed, which must then be > 0.
    initial : dict, optional
        Any of "V" [m/s], "theta" [s] and "tau" [Pa], which override the steady start.
        If M = 0, two of them determine the third.  If K = inf, V is the load point's speed, and
        theta and tau determine each other.  V may be 0 or negative with
        friction_form="regularized".
    times : array_like or DataArray, optional
        Times to save [s], in increasing order, from 0 to the shortest t_end: 1-D, or a DataArray
        with ``time`` and dimensions of the sweep.  By default a sweep is saved only at t_end.  A
        single slider is saved at each step of the solver, and at seven times within each Taylor
        step.
    rtol : float
        Error allowed in a step, in tau/(a sigma), ln V and ln theta: 1e-13 to 0.1, by default
        1e-6.  If K = inf, the solver uses at most 1e-12.
    method : {"auto", "rodas5p"}
        "auto" uses Taylor series of order 12 while the motion is not stiff, and Rodas5P otherwise.
        The series need a law whose formulas are sums, products, quotients and exponentials of
        speed and state.  The paper's own scheme is `ratestate.paper.im2017`.

    Returns
    -------
    xarray.Dataset
        In the sweep's dimensions, then ``time``.  If each case has its own times, they are the
        coordinate ``t``, which has the dimensions of the sweep and ``time``:

        - ``V`` and ``V_load``: speeds of slider and load point [m/s];
        - ``theta``: state [s];
        - ``delta`` and ``delta_lp``: displacements of slider and load point [m], with
          delta_lp(0) = 0 and delta(0) = -tau(0)/K;
        - ``tau``: stress of the spring [Pa];
        - ``mu``: friction coefficient for V and theta (eq. 1); NaN if either is beyond double
          precision;
        - ``sigma``: normal stress [Pa], if the loading changes it.

        Per case:

        - ``status`` (int8 with CF flags): 0 if the run finished;
        - ``steps``: number of steps of the solver;
        - ``energy_residual``: work of the load point minus stored and dissipated energy, divided by
          the sum of their magnitudes;
        - ``cycles``: number of stress maxima after the first, since the last jump in the loading;
        - ``amplitude`` (max - min of tau/sigma(0)), ``stress_drop`` [Pa] (max - min of tau) and
          ``frequency`` [Hz] of the last period; 0 if no period is found, or if the amplitude is
          below 10 * a * rtol.  The first maximum does not count;
        - ``returns``: number of stress maxima in this period, found from the later half of the last
          64 maxima.  It is 1 if all are equal, or if there are fewer than about 20.  It is 2 to 32
          if unequal maxima repeat in a fixed order.  It is 0 if they have no fixed order: then the
          amplitude covers all these maxima, and frequency is the number of maxima per second.  It
          is also 0 if no period is found;
        - ``V_max`` and ``V_min``: largest and smallest V of the run [m/s].  If M = 0, V_max is inf
          if V exceeds double precision but falls again;
        - ``inertial_force``: largest |M dV/dt|/sigma(0), which is |tau/sigma - mu| without damping;
        - ``mu_min`` and ``reversal_margin``: smallest mu, and smallest (tau + sigma mu)/sigma(0);
        - ``outside_domain`` (int8 with CF flags): whether the run leaves the domain of the friction
          law.  If mu_min is negative, friction would have to push.  If reversal_margin is negative,
          the spring pulls back harder than friction can hold.  With friction_form="regularized"
          slip reverses instead, and V_min is negative.

    Raises
    ------
    ParameterError
        If an argument cannot be used.
    QuasiStaticInstability
        If M = 0 and the quasi-static equations have no solution beyond some time before t_end.
    SolverError
        If a run fails for another reason.  The attribute ``best`` of both errors is the run up to
        its end, at the solver's own steps.  In a sweep no error is raised: the motion of such cases
        is NaN, and their status is the reason.

    Warns
    -----
    RunWarning
        If the run starts exactly in unstable steady sliding and nothing disturbs it: the load
        point's speed is constant, and V_start and `initial` agree with steady sliding.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.003, b=0.006, Dc="10 um", sigma="2 MPa", K="900 MPa/m", M=3000)
    >>> run = rs.simulate(slider, rs.Loading.steps("0.1 mm/s", (1.0, "3.2 mm/s")), t_end=11)
    >>> run.sizes["time"] > 1000 and int(run.status) == 0
    True
    >>> round(float(rs.simulate(slider, "10 um/s", "60 s", V_start="9 um/s").V[-1]), 9)
    1e-05
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
    """Return the `SimulateCall` with these arguments of `simulate`, checked one by one."""
    check_slider(slider)
    loading = as_loading(loading)
    rtol = solver_settings(rtol, method)
    t_end = to_si("t_end", t_end)
    V_start = None if V_start is None else to_si("V_start", V_start)
    initial = initial_values(initial, slider.friction_law)
    loading.covers(t_end)
    check_normal_stress(loading, slider, t_end)
    times = saved_times(times, t_end)
    return SimulateCall(slider, loading, t_end, V_start, initial, times, rtol, method)


@dataclasses.dataclass(frozen=True, eq=False)
class SimulateCall(CheckedCall):
    """`simulate` with its arguments, checked and in SI."""

    function = "simulate"
    loading: Loading
    t_end: Any
    V_start: Any = None  # the loading's first speed
    initial: dict = dataclasses.field(default_factory=dict)  # as from `initial_values`
    times: Any = None
    rtol: float = 1e-6
    method: str = "auto"
    # methods: the `BatchMotion` of all cases, and the variables of `run` from it
    move, variables = move, motion_variables

    @functools.cached_property
    def batch(self):
        """`Batch` of the slider's parameters, t_end, V_start and the initial values.

        Raises ParameterError if dimensions or coordinates clash, or if V_start is 0.
        """
        start = self.loading.V_first if self.V_start is None else self.V_start
        if not np.all(np.greater(start, 0.0)):
            raise refusal("simulate.at_rest")
        values = {**self.slider.values, "t_end": self.t_end, "V_start": start, **self.initial}
        histories = {"V_lp": self.loading.V}
        if (stress := self.loading.normal_stress) is not None:
            sinusoid = {"sigma_amplitude": stress.amplitude, "sigma_period": stress.period}
            values = {"alpha": 0.0, **values, **sinusoid}
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
        stress_names = () if self.loading.normal_stress is None else ("sigma",)
        return (*VARIABLES, *stress_names, *self.slider.friction_law.states)

    def check_fits(self):
        """Raise ParameterError if the results take more memory than there is."""
        times = 1 if self.times is None else self.times.shape[-1]
        bytes_per_row = BYTES + BYTES_OF_STATE * (len(self.slider.friction_law.states) - 1)
        check_fits(
            bytes_per_row * self.batch.n * times,
            f"the results of {self.batch.n:,} cases at {times:,} times",
            "Save fewer times, or sweep into a store, sweep(simulate, ..., store='x.zarr').",
        )

    def result(self, progress=None):
        """Return the Dataset; raise the exception of a single case that failed."""
        motion = self.move(progress)
        if self.batch.is_single and (status := motion.status[0]) != FINISHED:
            t, best = motion.numbers["t"][0], self._up_to_failure(motion)
            raise failure("simulate", self.slider, status, t, best, self.loading)
        return self.dataset(self.variables(motion))

    def _up_to_failure(self, motion):
        """Return the run up to its failure as a Dataset; None if it has too many own steps."""
        call, status = dataclasses.replace(self, times=None), motion.status[0]
        motion = motion if self.times is None else call.move(None)  # no saved time is the failure's
        return call.dataset(call.variables(motion)) if motion.status[0] == status else None

    def run(self, progress=None):
        """Return the variables, name -> Variable in the dimensions of the sweep, then time.

        A case that fails raises no error: it has its status.
        """
        return self.variables(self.move(progress))

    def blank(self):
        return self.variables(blank_motion(self.slider.friction_law, self.batch, self.times))

    @property
    def arguments(self):
        initial = {name.removesuffix("_initial"): x for name, x in self.initial.items()}
        return super().arguments | {"initial": initial or None}

    def dataset(self, variables):
        result = super().dataset(variables)
        if self.V_start is None:
            result = result.drop_vars("V_start", errors="ignore")
        return result.set_coords("t") if "t" in variables else result
