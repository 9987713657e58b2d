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


def measured_events(series, found, stiffness, several):
    """Return name -> (values (m,), standard errors (m,)) of all quantities of whole events.

    found : `Found`
    stiffness : `Stiffness`
    several : (m,) whether an event is several; the errors then hold for each of them, which has at
        least nothing and at most all of what is measured
    """
    K, K_error = stiffness.K, stiffness.error
    high, low = found.peak, found.trough
    start, end = high[:, 2], low[:, 2]
    V_lp, V_lp_error = series.load.speed(found.middle[:, 0])
    drop, drop_error = high[:, 0] - low[:, 0], np.hypot(high[:, 1], low[:, 1])
    amounts = {"stress_drop": (drop, drop_error)}
    if series.sigma is not None:
        sigma = np.interp(np.stack([start, end]), series.t, series.sigma)
        friction = high[:, 0] / sigma[0] - low[:, 0] / sigma[1]
        error = np.hypot(high[:, 1] / sigma[0], low[:, 1] / sigma[1])
        amounts["friction_drop"] = friction, error
    duration, duration_error = end - start, np.hypot(high[:, 3], low[:, 3])
    amounts["duration"] = duration, duration_error
    slip = series.load.moved(start, end) + drop / K
    error = np.hypot(np.hypot(drop_error, drop * K_error / K) / K, V_lp * duration_error)
    amounts["slip"] = slip, error
    fall, fall_error = found.slope.T
    error = np.hypot(np.hypot(fall_error, fall * K_error / K) / K, V_lp_error)
    amounts["peak_slip_rate"] = V_lp + fall / K, error
    # of a whole event the place of an extreme, and its value, err independently
    released = (high[:, 0] ** 2 - low[:, 0] ** 2) / (2.0 * K)
    error = np.hypot(high[:, 0] * high[:, 1], low[:, 0] * low[:, 1]) / K
    error = np.hypot(error, released * K_error / K)
    amounts["spring_energy"] = released, error
    load_error = 0.5 * (high[:, 0] + low[:, 0]) * V_lp * duration_error
    work = _load_work(series, start, end) + released
    amounts["friction_work"] = work, np.hypot(load_error, error)
    time_error = np.hypot(found.middle[:, 1], np.where(several, 0.5 * duration, 0.0))
    return {
        "event_time": (found.middle[:, 0], time_error),
        "event_start": (start, high[:, 3]),
        "event_end": (end, low[:, 3]),
        "tau_max": (high[:, 0], high[:, 1]),
        "tau_min": (low[:, 0], low[:, 1]),
        "V_lp": (V_lp, V_lp_error),
        **{
            name: (value, np.hypot(error, np.where(several, 0.5 * value, 0.0)))
            for name, (value, error) in amounts.items()
        },
    }


def _load_work(series, start, end):
    """(m,) integral of tau over delta_lp between two times [J/m^2]."""
    t, tau = series.t, series.tau
    steps = 0.5 * (tau[1:] + tau[:-1]) * series.load.moved(t[:-1], t[1:])
    total = np.concatenate([[0.0], np.cumsum(steps)])
    return np.interp(end, t, total) - np.interp(start, t, total)


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
