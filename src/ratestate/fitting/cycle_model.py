"""Limit cycles of many sliders at once, as waves, and their features."""

import numpy as np
import xarray

from ..cases import MAX_STEPS
from ..cycles import limit_cycle_call
from ..engine import drive
from ..engine.model import FINISHED, RODAS5P, Cases, Loads
from ..laws import evolution_law, mu_ss
from ..shooting import state, system_of
from ..slider import SpringSlider
from .features import FEATURES, LEVEL, profile_features, wave_profiles

# Phases at which a wave is known: even, and from the stress maximum on as a geometric sequence,
# for a drop may take any part of the period.
GRID = np.unique(np.concatenate([np.linspace(0.0, 1.0, 257), np.geomspace(1e-8, 0.5, 128)]))
# Of the cycle, and of the turn that draws it, in x, ln V and psi.
RTOL, TURN_RTOL = 1e-8, 1e-9


def limit_waves(law, values, V_lp):
    """Periods (n,) [s] and waves (n, q) of x = (tau/sigma - steady)/a at the phases `GRID`.

    values : symbol -> (n,) of a, b, Dc, sigma, K, M [SI];  V_lp : (n,) [m/s]
    NaN where a slider settles into no cycle.
    """

    def case(value):
        return xarray.DataArray(np.asarray(value, float), dims="case")

    n = V_lp.size
    slider = SpringSlider(**{s: case(v) for s, v in values.items()}, law=law)
    call = limit_cycle_call(slider, case(V_lp), rtol=RTOL)
    status, found = call.solve()
    period, waves = np.full(n, np.nan), np.full((n, GRID.size), np.nan)
    which = np.flatnonzero(status == FINISHED)
    if not which.size:
        return period, waves
    system = system_of(law, **call.batch.columns).at(which)
    turn = found["period"][which]
    one, k = np.ones(which.size), which.size
    cases = Cases(
        kappa=system.kappa,
        beta=system.beta,
        eta0=system.eta,
        scale=one,
        V0=one,
        y=np.ascontiguousarray(state(system, found["u"][which])),
        t_end=turn,
        dt=0.0 * one,
        loading=np.zeros(k, np.int64),
        times=np.arange(k),
        rtol=np.full(k, TURN_RTOL),
        observe=0.0 * one,
        v_limit=system.v_limit,
        max_steps=np.full(k, MAX_STEPS),
    )
    loads = Loads(np.zeros(1), np.ones((1, 1)), np.zeros((1, 1)))
    times = np.minimum(turn[:, None] * GRID, turn[:, None])
    code = evolution_law(law).code
    results = drive.run(RODAS5P, code, cases, loads, times, np.arange(k), False)
    saved = results.saved[..., 0]
    saved[results.status != FINISHED] = np.nan
    period[which] = turn * values["Dc"][which] / V_lp[which]
    waves[which] = saved
    return period, waves


class CycleModel:
    """Features of a slider's cycles at the speeds of a record, for many sliders at once.

    Parameters
    ----------
    law : str
    V_lp : (s,) speeds [m/s]
    bins : (s,) of the profile at each
    sigma, V0 : normal stress [Pa], speed at which friction is mu0 [m/s]
    """

    def __init__(self, law, V_lp, bins, sigma, V0):
        self.law, self.V_lp, self.bins, self.sigma, self.V0 = law, V_lp, bins, sigma, V0
        self.evaluations = 0

    def waves(self, values):
        """Periods (n, s) [s] and waves (n, s, q) of tau/sigma less mu0; NaN: no cycle."""
        n, s = values["a"].size, self.V_lp.size
        each = {symbol: np.repeat(value, s) for symbol, value in values.items()}
        V_lp = np.tile(self.V_lp, n)
        period, x = limit_waves(self.law, {**each, "sigma": np.full(n * s, self.sigma)}, V_lp)
        steady = mu_ss(V_lp, a=each["a"], b=each["b"], mu0=0.0, V0=self.V0)
        wave = steady[:, None] + each["a"][:, None] * x
        self.evaluations += n * s
        return period.reshape(n, s), wave.reshape(n, s, -1)

    def features(self, values, mu0=0.0):
        """(n, s, 6) as `profile_features`; NaN in all where there is no cycle.

        values : symbol -> (n,) of a, b, Dc, K, M [SI]
        """
        period, waves = self.waves(values)
        found = np.full((*period.shape, len(FEATURES)), np.nan)
        for j, bins in enumerate(self.bins):
            ok = np.isfinite(waves[:, j]).all(axis=1)
            profiles = wave_profiles(GRID, waves[ok, j], bins)
            found[ok, j] = profile_features(profiles, period[ok, j])
        found[~np.isfinite(found).all(axis=2)] = np.nan
        found[..., LEVEL] += mu0
        return found
