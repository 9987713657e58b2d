"""Times and friction in the Dataset of a record, checked."""

import numpy as np

from .refusals import refusal

#: bounds of friction, which may be a change from some level; farthest that a load point moves [m]
LOW, HIGH, FARTHEST = -0.1, 3.0, 10.0


def column(data, name):
    """(m,) values of a variable along time [SI]; refuses values that are not finite, by row."""
    if name not in data.variables:
        raise refusal("channels.absent", name=name, variables=variable_names(data))
    variable = data[name]
    if variable.dims != ("time",):
        raise refusal("channels.dimensions", name=name, dims=variable.dims)
    values = np.ascontiguousarray(variable.values, float)
    if not np.isfinite(values).all():
        row = int(np.argmin(np.isfinite(values)))
        raise refusal("channels.not_finite", name=name, value=values[row], row=row)
    return values


def variable_names(data):
    """The names of all variables, as a message lists them."""
    return ", ".join(map(str, data.variables)) or "no variable at all"


def check_sizes(friction, data):
    """Refuse values that no laboratory has: they are in another unit, or of another sign."""
    typical = float(np.median(friction))
    if not LOW < typical < HIGH:
        advice = "turn its sign" if -HIGH < typical < 0.0 else "is it a stress, or in per cent?"
        raise refusal("channels.size", typical=typical, high=HIGH, advice=advice)
    if "delta_lp" in data.variables:
        far = float(np.ptp(column(data, "delta_lp")))
        if far > FARTHEST:
            raise refusal("channels.far", far=far, farthest=FARTHEST)


def times_of(data):
    """(m,) times of the record [s], which must increase."""
    time = column(data, "time")
    if not (np.diff(time) > 0.0).all():
        row = int(np.argmin(np.diff(time) > 0.0)) + 1
        raise refusal("channels.not_increasing", before=time[row - 1], after=time[row], row=row)
    return time


def friction_of(data, slider):
    """The friction that was recorded: of "tau", the spring, or "mu", the interface; its values."""
    if "friction" in data.variables:
        return "tau", column(data, "friction")
    names = [name for name in ("tau", "mu") if name in data.variables]
    if len(names) == 2:
        raise refusal("channels.tau_and_mu")
    if not names:
        raise refusal("channels.no_friction", variables=variable_names(data))
    (kind,) = names
    values = column(data, kind)
    if kind == "mu":
        return kind, values
    sigma = data["sigma"] if "sigma" in data.variables else slider.sigma
    return kind, values / np.asarray(sigma, float)
