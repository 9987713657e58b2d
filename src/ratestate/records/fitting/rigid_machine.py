"""A rigid machine, K = inf, in the march, which has none: one so stiff that it counts as rigid.

Friction of a rigid one jumps with the speed of its load point.  What stands in for it takes a slip
of Dc/RIGID or so to follow, so a sample at the time of a jump is read that little later: it has the
friction after the jump, as a run of `simulate` has it there.
"""

import numpy as np

from ...dynamics.simulation.rigid_times import jumps

#: K Dc/(a sigma) of a machine that counts as rigid: friction follows within 1e-8 Dc of slip
RIGID = 1e8
#: slip, over Dc/RIGID, after which friction has followed a jump: it nears its value e-fold in 1
FOLLOWED = 100.0


def stiffness(a, Dc, sigma):
    """K of a machine that counts as rigid, (n,)."""
    return RIGID * a * sigma / Dc


def after_jumps(times, loads, Dc):
    """Times at which friction has followed the jumps that it has not quite followed at `times`.

    times : (n, m) or, the same for all, (1, m)
    loads : `Loads` of one row
    Dc : (n,)

    (n, m) or, where there are no jumps, as given.  A jump to rest has nothing that is followed:
    friction of a rigid machine falls without end.
    """
    for k in np.flatnonzero(jumps(loads, 0) & (loads.V[0] > 0.0)):
        jump = loads.t[k]
        followed = jump + FOLLOWED / RIGID * Dc[:, None] / loads.V[0, k]
        times = np.where((times >= jump) & (times < followed), followed, times)
    return times
