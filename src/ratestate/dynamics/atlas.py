"""The atlas: every limit cycle that a spring-slider of given b/a can have, on one map.

Three numbers decide what a steadily driven slider does: K/K_c_qs, eta and b/a.  For one b/a, any
machine, rig or fault is a point of the plane of the other two.  Raising the speed tenfold moves it
up by two decades of eta.
"""

import numpy as np
import xarray

from ..friction.laws import DEFAULT
from ..model.arrays import logspace
from ..model.quantities import attrs
from ..model.slider import SpringSlider
from ..model.units import is_array, to_si
from .continuation.coexistence import folds
from .cycles.limit_cycle import limit_cycle
from .cycles.regimes import REGIMES, classify
from .hopf import bautin, hopf
from .refusals import check_one_length, refusal
from .results import flags, provenance

#: first and last value of the axes: faults at the bottom left, brakes at the top
ETA, STIFFNESS = (1e-16, 1e4), (1e-2, 1e3)
#: first and last distance from K_c, 1 - K/K_c, of the columns that resolve the transition
CLOSE = (0.5, 1e-5)


def atlas(b_over_a=2.0, law=DEFAULT, *, n=200, rtol=1e-6):
    """The limit cycles over K/K_c_qs and eta, their regimes, and how sliding loses stability.

    Parameters
    ----------
    b_over_a : float
        b/a [1], > 1.
    law : str
        Friction law, one of one length.
    n : int
        Points along either axis, at least 2; half as many columns close to K_c.
    rtol : float
        Relative accuracy of the cycles.

    Returns
    -------
    xarray.Dataset
        Along ``eta`` and ``K_over_K_c_qs``: ``amplitude_over_a``, ``slip_per_cycle`` (V_lp period
        over Dc), ``frequency_over_f_n``, ``V_max_over_V_lp``, ``inertia``, ``fundamental``,
        ``slow_fraction``, ``regime`` (int8 with CF flags) and ``agree`` (see
        `ratestate.regimes.classify`), ``status``; the cycle is that which `limit_cycle` reaches.
        The same with the suffix ``_close`` along ``eta`` and ``K_over_K_c`` below 1.  Along
        ``eta``: ``K_c_over_K_c_qs``, ``lyapunov_1`` in units of V_lp/Dc and ``type`` of the Hopf
        bifurcation there, and ``K_fold_over_K_c_qs``, up to which a limit cycle coexists with
        stable steady sliding, NaN where none does.  Scalar: ``eta_bautin``, where the type
        changes; NaN if it does nowhere.

    Raises
    ------
    ParameterError
        Unknown law; b_over_a that is no number > 1; n that is no integer >= 2; rtol out of the
        range of `limit_cycle`.

    Examples
    --------
    >>> chart = atlas(2.0, n=8)
    >>> chart.sel(eta=1e4, K_over_K_c_qs=1.0, method="nearest").regime.item()  # quasi-harmonic
    3
    """
    check_one_length("atlas", law)
    b_over_a = to_si("b_over_a", b_over_a)
    if is_array(b_over_a) or not b_over_a > 1:
        raise refusal("atlas.b_over_a", b_over_a=b_over_a)
    eta, ratio = logspace("eta", *ETA, n), logspace("K_over_K_c_qs", *STIFFNESS, n)
    gap = np.geomspace(*CLOSE, max(n // 2, 2))
    close = xarray.DataArray(1.0 - gap, {"K_over_K_c": 1.0 - gap}, ("K_over_K_c",))
    # With a = Dc = sigma = V_lp = 1 the slider is its own dimensionless form, and M is eta.
    mass = eta.rename(eta="row").reset_coords(drop=True).drop_vars("row")
    slider = SpringSlider(a=1.0, b=b_over_a, Dc=1.0, sigma=1.0, K=1.0, M=mass, law=law)
    whole = _cycles_and_regimes(slider.replace(K=ratio * slider.K_c_qs), rtol)
    near = _cycles_and_regimes(slider.replace(K=close * slider.K_c(1.0)), rtol)
    near = near.rename({name: f"{name}_close" for name in near.data_vars})
    data = whole.merge(near).merge(_transition(slider, eta)).rename(row="eta")
    data = data.transpose("eta", ...).assign_coords(eta=eta.eta)
    data = data.assign_coords(b_over_a=((), b_over_a, attrs("b_over_a")))
    for name in ("K_over_K_c_qs", "K_over_K_c"):
        data[name].attrs = attrs(name)
    data.attrs = provenance("atlas", slider.replace(M=1.0), rtol=rtol, n=n, law=slider.law)
    return data


def _cycles_and_regimes(slider, rtol):
    """Cycles and regimes of dimensionless sliders, under the names of the atlas."""
    cycle = limit_cycle(slider, 1.0, rtol=rtol)
    regimes = classify(cycle)
    values = {
        "amplitude_over_a": cycle.amplitude,
        "slip_per_cycle": cycle.period,
        "frequency_over_f_n": cycle.frequency / slider.f_n,
        "V_max_over_V_lp": cycle.V_max,
        **{name: cycle[name] for name in ("inertia", "fundamental", "slow_fraction")},
        "agree": regimes.agree,
    }
    codes = np.vectorize(REGIMES.index, otypes=[np.int8])(regimes.regime)
    data = xarray.Dataset({name: value.assign_attrs(attrs(name)) for name, value in values.items()})
    data["regime"] = (regimes.regime.dims, codes, attrs("regime") | flags(dict(enumerate(REGIMES))))
    data["status"] = cycle.status
    return data.drop_vars(["K", "M", "V_lp"])


def _transition(slider, eta):
    """The Hopf bifurcation at K_c and the fold beyond it, along ``row``."""
    point = hopf(slider, 1.0)
    b_over_a = slider.b
    fold = folds(slider.law, np.full(eta.size, b_over_a), eta.values).kappa / (b_over_a - 1.0)
    change = bautin(slider.law, b_over_a)
    data = point[["lyapunov_1", "type"]].drop_vars(["M", "V_lp"])
    data["lyapunov_1"].attrs |= {"units": "1", "comment": "in units of V_lp/Dc"}
    data["K_c_over_K_c_qs"] = ("row", 1.0 + eta.values, attrs("K_c_over_K_c_qs"))
    data["K_fold_over_K_c_qs"] = ("row", fold, attrs("K_fold_over_K_c_qs"))
    data["eta_bautin"] = ((), np.nan if change is None else change, attrs("eta_bautin"))
    return data
