"""What follows for each event from its peak, trough, middle, steepest fall, and the stiffness.

With delta = delta_lp - tau/K slip in an event is delta_lp's way plus drop/K; the slip rate is
V_lp - (dtau/dt)/K; the spring's work on the block, the integral of tau over slip, is that over
delta_lp plus (tau_max^2 - tau_min^2)/(2 K), the energy that the spring loses.  Slip rate is V_lp at
both ends, so that the kinetic energy is the same, and this work is what friction (and damping, if
there is any) turns into heat.
"""

import math

import numpy as np

#: part by which V_lp may vary during an event, and between events whose recurrence counts
CHANGES = 0.02
#: peak slip rate over the inertial limit, or over V_lp, from which an event is fast
INERTIAL, FAST = 0.5, 100.0
#: status of an event -> what it means; the first that holds counts
STATUSES = {
    0: "whole",
    1: "cut by the start",
    2: "cut by the end",
    3: "V_lp changes",
    4: "undersampled",
    5: "gap in the record",
    6: "several events",
}
WHOLE, CUT_BY_START, CUT_BY_END, LOAD_CHANGES, UNDERSAMPLED, GAP, SEVERAL = STATUSES


def measured_events(series, found, stiffness):
    """Name -> (m,) values of all quantities of whole events, with ``NAME_error``.

    found : `Found`
    stiffness : `Stiffness`
    """
    K, K_error = stiffness.K, stiffness.error
    high, low = found.peak, found.trough
    start, end = high[:, 2], low[:, 2]
    V_lp, V_lp_error = series.load.speed(found.middle[:, 0])
    out = {
        "event_time": (found.middle[:, 0], found.middle[:, 1]),
        "event_start": (start, high[:, 3]),
        "event_end": (end, low[:, 3]),
        "tau_max": (high[:, 0], high[:, 1]),
        "tau_min": (low[:, 0], low[:, 1]),
        "V_lp": (V_lp, V_lp_error),
    }
    drop, drop_error = high[:, 0] - low[:, 0], np.hypot(high[:, 1], low[:, 1])
    out["stress_drop"] = drop, drop_error
    if series.sigma is not None:
        sigma = np.interp(np.stack([start, end]), series.t, series.sigma)
        friction = high[:, 0] / sigma[0] - low[:, 0] / sigma[1]
        out["friction_drop"] = friction, np.hypot(high[:, 1] / sigma[0], low[:, 1] / sigma[1])
    out["duration"] = end - start, np.hypot(high[:, 3], low[:, 3])
    out |= _slip(series, found, stiffness, out)
    # of a whole event the place of an extreme, and its value, err independently
    released = (high[:, 0] ** 2 - low[:, 0] ** 2) / (2.0 * K)
    released_error = np.hypot(high[:, 0] * high[:, 1], low[:, 0] * low[:, 1]) / K
    released_error = np.hypot(released_error, released * K_error / K)
    out["spring_energy"] = released, released_error
    load = _load_work(series, start, end)
    load_error = 0.5 * (high[:, 0] + low[:, 0]) * V_lp * out["duration"][1]
    out["friction_work"] = load + released, np.hypot(load_error, released_error)
    return out


def _slip(series, found, stiffness, out):
    """Slip and peak slip rate with their errors."""
    K, relative = stiffness.K, stiffness.error / stiffness.K
    drop, drop_error = out["stress_drop"]
    (V_lp, V_lp_error), duration_error = out["V_lp"], out["duration"][1]
    slip = series.load.moved(out["event_start"][0], out["event_end"][0]) + drop / K
    slip_error = np.hypot(np.hypot(drop_error / K, drop / K * relative), V_lp * duration_error)
    fall, fall_error = found.slope.T
    rate = V_lp + fall / K
    rate_error = np.hypot(np.hypot(fall_error / K, fall / K * relative), V_lp_error)
    return {"slip": (slip, slip_error), "peak_slip_rate": (rate, rate_error)}


def _load_work(series, start, end):
    """(m,) integral of tau over delta_lp between two times [J/m^2]."""
    t, tau = series.t, series.tau
    steps = 0.5 * (tau[1:] + tau[:-1]) * series.load.moved(t[:-1], t[1:])
    total = np.concatenate([[0.0], np.cumsum(steps)])
    return np.interp(end, t, total) - np.interp(start, t, total)


def with_several(values, several):
    """Values with errors that hold for each of the events that were measured as one.

    several : (m,) whether an event is several; each of them has at least nothing and at most all
    """
    values = dict(values)
    for name in (
        "stress_drop",
        "friction_drop",
        "duration",
        "slip",
        "spring_energy",
        "friction_work",
    ):
        if name in values:
            value, error = values[name]
            values[name] = value, np.where(several, np.hypot(error, 0.5 * value), error)
    time, error = values["event_time"]
    half = 0.5 * values["duration"][0]
    values["event_time"] = time, np.where(several, np.hypot(error, half), error)
    return values


def kinds(values, K, M):
    """(m,) "fast", "slow", or "unknown" where neither M nor a slip rate is known.

    A block that inertia alone limits slips as half a cosine in the natural half-period
    pi sqrt(M/K), at drop/(2 sqrt(K M)) at most (Johnson & Scholz 1976,
    doi:10.1029/JB081i005p00881; Rice & Tse 1986, doi:10.1029/JB091iB01p00521).
    """
    rate, drop = values["peak_slip_rate"][0], values["stress_drop"][0]
    if M is not None and M > 0.0:
        fast = rate * 2.0 * math.sqrt(K * M) >= INERTIAL * drop
    elif M is None:
        fast = rate >= FAST * values["V_lp"][0]
    else:
        fast = np.zeros(rate.size, bool)
    return np.where(np.isfinite(rate), np.where(fast, "fast", "slow"), "unknown")
