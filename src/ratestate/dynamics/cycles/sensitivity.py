"""How a limit cycle, its amplitude and its period change with a parameter.

On a canard they change by ten million times what the stiffness does, relatively: then the last
digit of a parameter, or the rounding of a turn, is what an amplitude is uncertain by.
"""

from typing import NamedTuple

import numpy as np

from .iterates import iterate
from .shooting import newton_step

# Relative change of a parameter for derivatives: the smallest, and over the tolerance of a turn.
# A canard may be all over within 1e-7, and multiplies the errors of a turn by as much.
LEAST_CHANGE, CHANGE = 1e-9, 1e3
# What errors are worth as relative changes of K: those of a step, over its tolerance, and rounding,
# of the parameters and in a turn.
TRUNCATION, ROUNDING = 0.3, 5.0 * 2.0**-52
# Of two turns whose difference tells the errors that steps gather: how much coarser one is.
COARSER = 2.0


class Measured(NamedTuple):
    """Logarithms of amplitude (of x), period, V_max and V_min, in this order, of n orbits."""

    values: np.ndarray  # (n, 4)
    by_u: np.ndarray  # (n, 4, 2) their derivatives with respect to (psi, G) at the beginning


class Slopes(NamedTuple):
    """Derivatives with respect to a parameter's logarithm, the point u held."""

    image: np.ndarray  # (n, 2) of the next u
    values: np.ndarray  # (n, 4) of what `Measured` has


def measured(turns):
    """`Measured` of what `iterate` found, extremes observed."""
    of = turns.numbers

    def row(suffix):
        return [
            (of[f"x_high{suffix}"] - of[f"x_low{suffix}"]) / amplitude,
            of[f"period{suffix}"] / of["period"],
            of[f"v_max{suffix}"],
            of[f"v_min{suffix}"],
        ]

    with np.errstate(divide="ignore", invalid="ignore"):
        amplitude = of["x_high"] - of["x_low"]
        values = [np.log(amplitude), np.log(of["period"]), of["v_max"], of["v_min"]]
        by_u = np.array([row("_a"), row("_b")])
    return Measured(np.array(values).T, by_u.transpose(2, 1, 0))


def parameter_change(tol):
    """(n,) relative change of a parameter by which `slopes` takes differences."""
    return np.maximum(LEAST_CHANGE, CHANGE * tol)


def slopes(changed, settled, turns, tol):
    """`Slopes` by one orbit more, of the sliders `changed`.

    settled, turns : `attractor.Settled`, and what `iterate` found from there at the
        tolerance tol (n,)
    changed : the sliders with the parameter larger by the factor 1 + `parameter_change`
    """
    others = iterate(changed, settled.u, tol, settled.returns, alone=False, period=settled.period)
    h = parameter_change(tol)[:, None]
    values = measured(others).values - measured(turns).values
    return Slopes((others.image - turns.image) / h, values / h)


def stiffness_slopes(system, settled, turns, tol):
    """`Slopes` with respect to ln K."""
    changed = system._replace(kappa=system.kappa * (1.0 + parameter_change(tol)))
    return slopes(changed, settled, turns, tol)


def defect(system, tol):
    """(n,) relative change of K that the errors of a turn at this tolerance are worth.

    The rounding of b/a counts as much more as b - a is smaller than b.
    """
    return TRUNCATION * tol + ROUNDING * system.beta / (system.beta - 1.0)


def stiffness_sensitivity(system, settled, turns, tol):
    """(n, 4) relative changes of a cycle's amplitude, period, V_max and V_min over that of K.

    settled, turns : `attractor.Settled`, and what `iterate` found from there at the
        tolerance tol (n,)
    """
    by_K = stiffness_slopes(system, settled, turns, tol)
    du = newton_step(turns._replace(image=settled.u + by_K.image), settled.u)
    with np.errstate(invalid="ignore", over="ignore"):
        # (not a product of matrices: numpy rounds it otherwise for one case than for several)
        by_u = (measured(turns).by_u * du[:, None, :]).sum(axis=2)
        return np.abs(by_u + by_K.values)
