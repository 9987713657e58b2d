"""The atlas: every limit cycle that a spring-slider of given b/a can have, on one map.

Three numbers decide what a steadily driven slider does: K/K_c_qs, eta and b/a.  For one b/a, any
machine, rig or fault is a point of the plane of the other two.  Ten times the speed moves it up by
two decades of eta.  Parameters of the law's own, divided by a, sigma or Dc, come in addition.  A
law with a speed of its own depends on speed, so its map has the axes K and V_lp.
"""

from collections.abc import Sequence

import numpy as np
import xarray

from ..friction.laws import DEFAULT, friction_law
from ..model.parameters import logspace
from ..model.quantities import attrs
from ..model.slider import SpringSlider
from ..model.units import is_array, to_si
from .continuation.coexistence import folds
from .cycles.limit_cycle import limit_cycle
from .cycles.regimes import REGIMES, classify
from .hopf import bautin, hopf
from .refusals import refusal
from .results import flags, provenance

#: first and last value of the axes: faults at the bottom left, brakes at the top
ETA, STIFFNESS = (1e-16, 1e4), (1e-2, 1e3)
#: V_lp of laws with a speed of their own
SPEEDS = (1e-6, 1e4)
#: first and last distance from K_c, 1 - K/K_c, of the columns that resolve the transition
CLOSE = (0.5, 1e-5)


def atlas(
    b_over_a=2.0,
    law=DEFAULT,
    *,
    n=200,
    rtol=1e-6,
    eta=ETA,
    K_over_K_c_qs=STIFFNESS,
    transition=True,
    M=None,
    **parameters,
):
    """Compute limit cycles and regimes over K/K_c_qs and eta, and how sliding loses stability.

    Under a law that has a speed among its parameters, such as ``kato-tullis``, V_lp from 1e-6 to
    1e4 takes the place of eta.

    Parameters
    ----------
    b_over_a : float
        b/a [1], > 1.
    law : str
        Friction law.
    n : int
        Points along either axis, at least 2.
    rtol : float
        Relative accuracy of the cycles.
    eta, K_over_K_c_qs : pair of float
        First and last value along the axes, > 0, to map a part only.  If the law has a speed among
        its parameters, eta cannot be given.
    transition : bool
        Whether to add columns close to K_c, half as many as n, but at least 2.
    M : float
        Mass, >= 0, in units in which it equals eta at V_lp = 1.  Only for a law with a speed among
        its parameters.
    **parameters : float
        Parameters of the law in addition to a, b and Dc, in units in which a = sigma = Dc = 1.  So
        b2 means b2/a, and speeds are in the unit of V_lp, which you may choose.

    Returns
    -------
    xarray.Dataset
        - Along ``eta`` and ``K_over_K_c_qs``: ``amplitude_over_a``, ``slip_per_cycle`` (V_lp
          period/Dc), ``frequency_over_f_n``, ``V_max_over_V_lp``, ``inertia``, ``fundamental``,
          ``slow_fraction`` and ``status`` of the cycle that `limit_cycle` reaches.  In steady
          sliding amplitude_over_a, inertia and slow_fraction are 0, V_max_over_V_lp is 1, and the
          other numbers are NaN.
        - Along the same axes: ``regime`` (int8: 0 steady, 1 slow stick-slip, 2 stick-slip,
          3 quasi-harmonic, 4 unknown) and ``agree`` (see `ratestate.classify`).
        - With `transition`, the same with the suffix ``_close`` along ``eta`` and ``K_over_K_c``
          below 1.
        - Along ``eta``: ``K_c_over_K_c_qs``, ``lyapunov_1_Dc_over_V_lp`` and ``type`` of the Hopf
          bifurcation at this eta.
        - Along ``eta``: ``K_fold_over_K_c_qs``, the largest stiffness at which a limit cycle
          coexists with stable steady sliding.  It is NaN if none does, or if d theta/dt depends on
          more than V theta/Dc.
        - Scalar ``eta_bautin``: eta at which the type changes.  It is NaN if the type does not
          change, or if d theta/dt depends on more than V theta/Dc.

        Under a law with a speed among its parameters, ``V_lp`` replaces ``eta``, which becomes a
        coordinate along ``V_lp``.  K_c_qs is then the largest at any of these speeds.

    Raises
    ------
    ParameterError
        If the law is unknown, or one of its parameters is missing or unknown.  If M is given for a
        law without a speed, or missing for a law with one, or eta is given for a law with a speed.
        If b_over_a is not a number > 1, n not an integer >= 2, eta or K_over_K_c_qs not a pair > 0,
        or rtol out of range.  If steady sliding is stable at any stiffness, for example if b2 < 0.

    Examples
    --------
    >>> chart = atlas(2.0, n=8)
    >>> chart.sel(eta=1e4, K_over_K_c_qs=1.0, method="nearest").regime.item()  # quasi-harmonic
    3
    """
    friction = friction_law(law)
    for symbol, value in {**parameters, **({} if M is None else {"M": M})}.items():
        if symbol not in (*friction.parameters, "M"):
            raise refusal("atlas.parameter", law=friction.name, symbol=symbol)
        if not isinstance(value, int | float):
            raise refusal("atlas.number", symbol=symbol, value=value)
    for symbol, ends in {"eta": eta, "K_over_K_c_qs": K_over_K_c_qs}.items():
        if not isinstance(ends, Sequence | np.ndarray) or len(ends) != 2:
            raise refusal("atlas.pair", symbol=symbol, value=ends)
    b_over_a = to_si("b_over_a", b_over_a)
    if is_array(b_over_a) or not b_over_a > 1:
        raise refusal("atlas.b_over_a", b_over_a=b_over_a)
    # With a = Dc = sigma = 1, and V_lp = 1 if there is no other speed, the slider is its own
    # dimensionless form, and M is eta.
    units = dict.fromkeys(("a", "Dc", "sigma", "K"), 1.0)
    mass = 1.0 if M is None else M
    slider = SpringSlider(**units, b=b_over_a, M=mass, law=law, **parameters)
    if slider.friction_law.has_speed_scale != (M is not None):
        raise refusal(f"atlas.{'mass' if M is None else 'no_mass'}", law=slider.law)
    if slider.friction_law.has_speed_scale and tuple(eta) != ETA:
        raise refusal("atlas.no_eta", law=slider.law)
    sliders, V_lp, rows = _rows(slider, eta, n)
    ratio = logspace("K_over_K_c_qs", K_over_K_c_qs[0], K_over_K_c_qs[1], n)
    data = _map(sliders, V_lp, rows, ratio, transition, rtol)
    data = data.assign_coords(b_over_a=((), b_over_a, attrs("b_over_a")))
    data.attrs = provenance("atlas", slider, rtol=rtol, n=n, law=slider.law)
    return data


def _rows(slider, eta, n):
    """Return sliders and load-point speeds along the dimension ``row``, and its coordinates."""
    if slider.friction_law.has_speed_scale:
        speeds = logspace("V_lp", *SPEEDS, n)
        V_lp = xarray.DataArray(speeds.values, dims="row")
        eta = ("V_lp", slider.M * speeds.values**2, attrs("eta"))
        return slider, V_lp, {"V_lp": speeds.V_lp, "eta": eta}
    values = logspace("eta", eta[0], eta[1], n)
    return slider.replace(M=xarray.DataArray(values.values, dims="row")), 1.0, {"eta": values.eta}


def _map(slider, V_lp, rows, ratio, transition, rtol):
    """Return the atlas of sliders along ``row``, with these coordinates, the first its own."""
    critical = slider.K_c(V_lp)
    reference = float(np.max(slider.replace(M=0.0).K_c(V_lp)))
    if not np.min(critical) > 0.0:
        raise refusal("atlas.stable", law=slider.law)
    data = _cycles_and_regimes(slider.replace(K=ratio * reference), V_lp, rtol)
    if transition:
        gap = np.geomspace(*CLOSE, max(ratio.size // 2, 2))
        close = xarray.DataArray(1.0 - gap, {"K_over_K_c": 1.0 - gap}, ("K_over_K_c",))
        near = _cycles_and_regimes(slider.replace(K=close * critical), V_lp, rtol)
        data = data.merge(near.rename({name: f"{name}_close" for name in near.data_vars}))
    data = data.merge(_transition(slider, V_lp, critical / reference))
    dim = next(iter(rows))
    data = data.rename(row=dim).transpose(dim, ...).assign_coords(rows)
    for name in {"K_over_K_c_qs", "K_over_K_c"} & {*data.coords}:
        data[name].attrs = attrs(name)
    return data


def _cycles_and_regimes(slider, V_lp, rtol):
    """Return cycles and regimes of dimensionless sliders, under the names of the atlas."""
    cycle = limit_cycle(slider, V_lp, rtol=rtol)
    regimes = classify(cycle)
    values = {
        "amplitude_over_a": cycle.amplitude,
        "slip_per_cycle": V_lp * cycle.period,
        "frequency_over_f_n": cycle.frequency / slider.f_n,
        "V_max_over_V_lp": cycle.V_max / V_lp,
        **{name: cycle[name] for name in ("inertia", "fundamental", "slow_fraction")},
        "agree": regimes.agree,
    }
    codes = np.vectorize(REGIMES.index, otypes=[np.int8])(regimes.regime)
    data = xarray.Dataset({name: value.assign_attrs(attrs(name)) for name, value in values.items()})
    data["regime"] = (regimes.regime.dims, codes, attrs("regime") | flags(dict(enumerate(REGIMES))))
    data["status"] = cycle.status
    return data.drop_vars(["K", "M", "V_lp"], errors="ignore")


def _transition(slider, V_lp, critical):
    """Return the Hopf bifurcation at K_c and the fold beyond it, along ``row``.

    critical : K_c/K_c_qs
    """
    point = hopf(slider, V_lp)
    data = point[["type"]].drop_vars(["M", "V_lp"], errors="ignore")
    name = "lyapunov_1_Dc_over_V_lp"
    data[name] = (point.lyapunov_1 / V_lp).variable
    data[name].attrs = attrs(name)
    data["K_c_over_K_c_qs"] = ("row", np.asarray(critical), attrs("K_c_over_K_c_qs"))
    fold, change = np.full(data.sizes["row"], np.nan), np.nan
    if slider.friction_law.one_length:
        eta = np.asarray(slider.M)
        fold = folds(slider.law, np.full(eta.size, slider.b), eta).kappa / (slider.b - 1.0)
        change = bautin(slider.law, slider.b)
    data["K_fold_over_K_c_qs"] = ("row", fold, attrs("K_fold_over_K_c_qs"))
    data["eta_bautin"] = ((), change, attrs("eta_bautin"))
    return data
