"""Five problems with known answers, as pages that measure errors use them."""

import numpy as np

import ratestate as rs

FRICTION = {"Dc": 1e-5, "mu0": 0.6, "V0": 1e-9}
FIG2 = FRICTION | {"a": 0.003, "b": 0.006, "sigma": 2e6, "M": 3e3, "K": 9e8}
FIG4 = FRICTION | {"a": 0.005, "b": 0.008, "sigma": 4e6, "M": 1e2, "K": 9.6e8}

# name -> what it is; slider, law, speed of the steady start, V_lp, t [SI];
# then tau/sigma - mu0, ln(V/V0) and psi = ln(V0 theta/Dc) at t, in quadruple precision
PROBLEMS = {
    "P1": (
        "vibration, slip law",
        *(FIG2, "slip", 1e-4, 3.2e-3, 10.0),
        *(-0.04515566728922, 14.84312491051, -14.938658649),
    ),
    "P4a": (
        "vibration, aging law",
        *(FIG2, "aging", 1e-4, 3.2e-3, 10.0),
        *(-0.04390204256013, 15.06571693061, -14.90710298778),
    ),
    "P2": (
        "stick-slip at 10 um/s, slip law",
        *(FIG4, "slip", 5e-6, 1e-5, 330.0),
        *(-0.05091247702335, 6.421857000585, -10.3777202534),
    ),
    "P4b": (
        "stick-slip at 10 um/s, aging law",
        *(FIG4, "aging", 5e-6, 1e-5, 360.0),
        *(-0.04271483396164, 1.704206223123, -6.404483134664),
    ),
    "P3": (
        "stick-slip at 0.1 um/s, slip law",
        *(FIG4, "slip", 5e-8, 1e-7, 46000.0),
        *(-0.04374171674246, 1.646292721092, -6.49664754349),
    ),
}


def slider_of(name):
    """The slider of a problem, and its loading speed."""
    _, parameters, law, _, V_lp, *_ = PROBLEMS[name]
    return rs.SpringSlider(**parameters, law=law), V_lp


def solved(name, rtol):
    """Errors of tau/sigma, ln V and psi at the end of a problem, and the number of steps."""
    slider, V_lp = slider_of(name)
    _, p, _, V_start, _, t, *exact = PROBLEMS[name]
    run = rs.simulate(slider, V_lp, t, V_start=V_start, times=[t], rtol=rtol)
    end = run.isel(time=-1)
    state = (
        float(end.tau) / p["sigma"] - p["mu0"],
        np.log(float(end.V) / p["V0"]),
        np.log(p["V0"] * float(end.theta) / p["Dc"]),
    )
    return np.abs(np.subtract(state, exact)), int(run.steps)
