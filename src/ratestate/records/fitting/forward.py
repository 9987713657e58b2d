"""Friction that a load cell would show, as a function of the coordinates, with derivatives.

Derivatives are central differences between sliders in neighbouring lanes of the march.  The
2 k + 1 sliders of one jacobian take little longer than one slider, under every law and loading.
Neighbours take nearly the same steps, so that most of their errors cancel: with rtol = 1e-8 and
differences of 3e-5, derivatives are accurate to 1e-6.  Fits of cycles use `marched` as well.
"""

import dataclasses

import numpy as np

from ...dynamics.simulation.engine_cases import V_LIMIT, comes_to_rest, engine_loads
from ...engine import backend, dispatch
from ...engine.model import FINISHED, RIGID_REST, STATUSES, Cases, Loads
from ...errors import ParameterError
from ...friction.composition import under_varying_stress
from ...model.arrays import Batch
from .unknowns import LINEAR, motion_symbols, parameter, sizes_of, start_names

RTOL = 1e-8
#: most steps of a march: 100 times those of a slider that fits, so that vibration is rejected
MAX_STEPS_OF_FIT = 1e5
#: steps of Newton's method for mu0; finite difference in level, trend and mu0
NEWTON_STEPS, LINEAR_STEP = 3, 1e-3


class ForwardModel:
    """Observable values as functions of the coordinates, and their derivatives.

    names : names of the coordinates
    steps : name -> step of a central difference, for all coordinates except `LINEAR`
    """

    def __init__(self, names, steps):
        self.names, self.steps, self.evaluations = names, steps, 0

    def values(self, points):
        """Return name -> (n,) values [SI] at points (n, k)."""
        raise NotImplementedError

    def friction_and_regressors(self, points):
        """Return `friction`, and name -> its derivative (n, m) by linear parameters."""
        raise NotImplementedError

    def friction(self, points):
        """Return friction (n, m) at the samples for points (n, k); NaN without a motion.

        Friction is level + (tau/sigma or mu, less its value in steady sliding at the record's first
        speed) + trend times slip or time.
        """
        return self.friction_and_regressors(points)[0]

    def jacobian(self, point):
        """Return friction (m,) at a point (k,) and its derivatives (m, k).

        Both are NaN without a motion.  A derivative is one-sided if there is a motion on one side.
        """
        moving = [self.names.index(name) for name in self.steps]
        above, below = self.neighbours(point)
        points = np.concatenate([point[None], above[moving], below[moving]])
        friction, regressors = self.friction_and_regressors(points)
        centre, *others = friction
        columns = np.zeros((len(self.names), centre.size))
        for i, up, down in zip(moving, others[: len(moving)], others[len(moving) :], strict=True):
            steps = above[i, i] - point[i], point[i] - below[i, i]
            columns[i] = _difference(up, centre, down, *steps)
        for name, regressor in regressors.items():
            if name in self.names:
                columns[self.names.index(name)] = regressor[0]
        return centre, columns.T

    def neighbours(self, point):
        """Return points (k, k) above and below a point (k,).

        In row i, coordinate i is moved by a step, but not below the parameter's lowest value.
        """
        steps = np.array([self.steps.get(name, LINEAR_STEP) for name in self.names])
        least = np.array([parameter(name).least for name in self.names])
        down = np.minimum(steps, np.maximum(point - least, 0.0))
        return point + np.diag(steps), point - np.diag(down)


class Forward(ForwardModel):
    """Friction of a slider under the loading of a record, for many sliders at once.

    slider : gives the parameters that are not among the names of the coordinates (unknowns.py)
    """

    def __init__(self, record, slider, names):
        sizes = sizes_of(record, slider)
        rows = {name: parameter(name) for name in names if name not in LINEAR}
        scales = {name: 1.0 if row.is_log else sizes[name] for name, row in rows.items()}
        super().__init__(names, {n: row.step(record, scales[n]) for n, row in rows.items()})
        self.record, self.law = record, slider.friction_law
        symbols = (*motion_symbols(self.law), "sigma", "alpha")
        self.fixed = {symbol: getattr(slider, symbol) for symbol in symbols}
        self.sigma = slider.sigma
        loading = record.loading
        self.V0 = float(loading.V[0])  # reference: v = 0 in steady sliding at this speed
        self.loads, row = engine_loads(Batch({"sigma": slider.sigma}), loading)
        self.load_rows: int | np.ndarray = 0
        self.max_steps = MAX_STEPS_OF_FIT
        if np.isinf(slider.K) and "K" not in names:
            self.fixed["M"] = 0.0  # inertia does not affect a rigid machine
            self.max_steps *= 10.0  # the march takes smaller steps
            if comes_to_rest(self.loads, row, record.t[-1:]):
                raise ParameterError(STATUSES[RIGID_REST][1])
        self.stress = loading.normal_stress
        self.moving_law = self.law if self.stress is None else under_varying_stress(self.law)
        self.needs_mu0 = "mu0" in self.moving_law.slider_parameters
        # V may run away if there is neither inertia nor damping
        may_run_away = self.fixed["M"] == 0.0 and not self.fixed.get("damping")
        self.v_limit = np.log(V_LIMIT / self.V0) if may_run_away else np.inf

    def push(self, start, end, speed):
        """Move the load point faster from start to end [s], in each of n sliders, all (n, 1).

        From then on only n points can be evaluated at a time.
        """
        loading, t = self.record.loading, np.unique([*self.loads.t, *start.flat, *end.flat])
        speeds = loading.speed.refined(t[t < loading.speed.until])
        refined = dataclasses.replace(loading, speed=speeds)
        loads, _ = engine_loads(Batch({"sigma": self.sigma}), refined)
        many = (np.repeat(table, len(start), axis=0) for table in loads[1:])
        self.loads, self.load_rows = Loads(loads.t, *many), np.arange(len(start))
        self.loads.V[...] += np.where((loads.t >= start) & (loads.t < end), speed, 0.0)

    def friction_and_regressors(self, points):
        values = self.values(points)
        steady = self.steady(values)
        saved = self._motion(values, steady)
        a, K = values["a"][:, None], values["K"][:, None]
        x, v, psi = saved[..., 0], saved[..., 1], np.moveaxis(saved[..., 2:], -1, 0)
        shown, is_mu = x, self.record.kind == "mu"
        if is_mu:
            with np.errstate(over="ignore", invalid="ignore"):
                of_samples = tuple(column[:, None] for column in steady.p)
                shown = self.law.at(v, tuple(psi), of_samples).R
        friction = shown - np.reshape(steady.R if is_mu else steady.S, (-1, 1))
        friction *= a
        if self.stress is not None and not is_mu:  # tau divided by the current sigma
            level, delayed = self.record.level, self.record.t - values["lag"][:, None]
            stress = self.stress.with_sigma(self.sigma).at(np.maximum(delayed, 0.0))
            friction = (level + friction) / (stress / self.sigma) - level
        along = np.broadcast_to(self.record.trend_variable, x.shape)
        if self.record.trend == "slip":
            along = along - (a * self.sigma / K) * (x - x[:, :1])
        regressors = self.record.regressors(along)
        for name, regressor in regressors.items():
            friction += values[name][:, None] * regressor
        self.evaluations += len(friction)
        return friction, regressors

    def values(self, points):
        """Return name -> (n,) values [SI] of the slider, and of lag, level and trend.

        Values of `start_names` are logarithms of ratios.  V0 is the record's first speed.  mu0 is
        included if motion depends on friction itself: the level is steady friction at V0.
        """
        fixed = dict.fromkeys((*start_names(self.law), "lag", *LINEAR), 0.0) | self.fixed
        fixed["V0"] = self.V0
        values = {name: np.full(len(points), float(value)) for name, value in fixed.items()}
        with np.errstate(over="ignore"):
            for i, name in enumerate(self.names):
                moved = points[:, i]
                values[name] = np.exp(moved) if parameter(name).is_log else moved
        if self.needs_mu0:
            values["mu0"] = self.mu0(values, np.full(len(points), self.record.level))
        return values

    def mu0(self, values, level):
        """Return mu0 (n,) at the V0 of the values, from the level (n,) of friction.

        level : friction of the record in steady sliding at its first speed
        """
        shown = self.law.steady_friction if self.record.kind == "mu" else self.law.steady_tau
        mu0, is_known = level, np.zeros(np.shape(level), bool)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            for _ in range(NEWTON_STEPS):
                here = shown(self.V0, values | {"mu0": mu0})
                is_known |= np.abs(here - level) <= 1e-15 * np.abs(level)
                if is_known.all():
                    break
                above = shown(self.V0, values | {"mu0": mu0 + LINEAR_STEP})
                step = (level - here) * LINEAR_STEP / (above - here)
                mu0 = np.where(is_known, mu0, mu0 + step)
        return mu0

    def start(self, values, steady):
        """Return ln(V/V0) (n,) at the start, and ln(V0 theta/D) (n,) of the states."""
        V_start, *states = (values[name] for name in start_names(self.law))
        logs = self.law.log_states(0.0, steady.psi, steady.p)
        return V_start, tuple(x + y for x, y in zip(logs, states, strict=True))

    def steady(self, values):
        """Return the `Point` of steady sliding at V0."""
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            return self.law.steady(self.law.coefficient_arrays(self.V0, values))

    def _motion(self, values, steady):
        """Return x, v, psi (n, m, 2 + states) at the samples."""
        a, Dc, K, M = (values[symbol] for symbol in ("a", "Dc", "K", "M"))
        p = of_motion = steady.p
        if self.stress is not None:
            own = {"sigma_amplitude": self.stress.amplitude, "sigma_period": self.stress.period}
            of_motion = self.moving_law.coefficient_arrays(self.V0, values | own)
        times = self.record.t[None]
        if "lag" in self.names:
            # samples delayed to before the start have the value at the start
            times = times - values["lag"][:, None]
        which = np.arange(a.size) if len(times) > 1 else np.zeros(a.size, np.int64)
        end = np.maximum(times[:, -1], 1e-9 * self.record.t[-1])
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            log_w, log_states = self.start(values, steady)
            psi = self.law.variables(log_w, log_states, p)
            x = self.law.at_speed(log_w, psi, p).S
            v = self.law.v_at(np.exp(log_w), psi, p)
            per_stress = 1.0 / (a * self.sigma)
            cases = cases_of(
                kappa=K * Dc * per_stress,
                loading=self.load_rows,
                p=np.stack(of_motion, axis=1),
                sigma=self.sigma,
                eta0=M * self.V0**2 * per_stress / Dc,
                scale=self.V0 / Dc,
                V0=self.V0,
                y=np.stack(np.broadcast_arrays(x, v, *psi), axis=1),
                t_end=np.full(a.size, end),
                times=which,
                rtol=RTOL,
                v_limit=self.v_limit,
                max_steps=self.max_steps,
            )
        return marched(self.moving_law, cases, self.loads, times)


def _difference(above, centre, below, up, down):
    """Return a derivative, one-sided if only one side has a motion, or NaN."""
    if not np.isfinite(above[-1]):
        above, up = centre, 0.0
    if not np.isfinite(below[-1]):
        below, down = centre, 0.0
    return (above - below) / (up + down) if up + down > 0.0 else np.full_like(centre, np.nan)


def cases_of(*, kappa, **columns):
    """Return `Cases` of n sliders under one loading; a number serves all sliders."""
    columns = {"loading": 0, "observe": 0.0, "sigma": 1.0, "kappa": kappa} | columns
    filled = {k: np.full(kappa.size, v) if np.ndim(v) == 0 else v for k, v in columns.items()}
    return Cases(**filled)


def marched(law, cases, loads, times):
    """Return x, v, psi (n, m, 2 + states) of cases at times; NaN if a run fails."""
    backend.check_stopped()  # a march may be too short to look
    results = dispatch.run_march(True, law, cases, loads, times, np.arange(cases.kappa.size))
    results.saved[results.status != FINISHED] = np.nan
    return results.saved
