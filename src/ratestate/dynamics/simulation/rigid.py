"""The rigid limit K = inf: V = V_lp at all times, and only the state evolves."""

import numpy as np

from .rigid_extremes import FRICTION, WITH_STRENGTH, lowest
from .rigid_path import Path
from .rigid_times import grid, stress_jumps


def rigid_motion(law, psi0, t, loads, row, p):
    """States (m, len(y)) x, v, psi at times t, and the numbers of a run as the engine reports them.

    Returns None where the load point rests at any time before t_end.  tau includes the force
    M dV_lp/dt that a ramp takes; the impulse of a jump is not shown.  SolverError where the state
    cannot be followed.

    law : as the engine needs it
    psi0 : (n_states,) the law's variables at t = 0
    loads, row : `Loads`, and the row of this slider in its tables
    p : the slider's parameters and t_end [SI] as attributes
    """
    path = Path(law, loads, row, p)
    if not (path.reached > 0.0).all():
        return None
    sampled = grid(loads, row, p)
    times = np.union1d(t, sampled)
    followed = path.states(psi0, times)
    psi = followed[:, np.searchsorted(times, t)]
    jumps = loads.t[stress_jumps(loads, row) & (loads.t < p.t_end)]
    of_all = sampled, followed[:, np.searchsorted(times, sampled)], jumps
    # The load point's work is friction's, by V = V_lp: no energy_residual.
    numbers = dict.fromkeys("steps energy_residual amplitude cycles returns".split(), 0.0) | {
        "t": p.t_end,
        "v_max": path.order(path.reached.max()),
        "v_min": path.order(path.reached.min()),
        "g_max": np.abs(path.inertia[path.lines.t < p.t_end]).max(),
        "f_min": lowest(path, FRICTION, *of_all),
        "xf_min": lowest(path, WITH_STRENGTH, *of_all),
    }
    at = path.at(t, psi)
    return np.stack([path.force(at), at.v, *psi], axis=-1), numbers
