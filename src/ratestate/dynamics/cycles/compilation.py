"""The part of the solver that finds limit cycles, compiled while this process runs another."""

from ...engine.compilation import compile_elsewhere
from ...engine.return_map import march_to_section
from ...friction.laws import friction_law

# One return of one slider; nothing is imported that this does not need.
ANY_RETURN = """
import numpy as np
from ratestate.dynamics.cycles.shooting import return_map
from ratestate.dynamics.cycles.system import system_of
one = np.ones(1)
system = system_of({law!r}, a=one, b=2.0 * one, Dc=one, sigma=one, K=0.5 * one, M=one, V_lp=one)
return_map(system, np.array([[0.1, 0.0, 0.1]]), 1e-3, alone=True)
"""


def compile_cycles_elsewhere(law):
    """Let another process compile what `limit_cycle` needs, which then waits for it.

    Without effect where that is compiled already.  ParameterError for an unknown law.

    law : str, name of an evolution law
    """
    compile_elsewhere(march_to_section, friction_law(law), ANY_RETURN.format(law=law))
