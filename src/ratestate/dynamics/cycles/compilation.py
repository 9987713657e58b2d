"""The part of the solver that finds limit cycles, compiled while this process runs another."""

from ...engine.compilation import compile_elsewhere
from ...engine.return_map import march_to_section
from ...friction.composition import composed_law, own_name
from ...model.user_laws import recorded

# One return of one slider; nothing is imported that this does not need.
ANY_RETURN = """
import numpy as np
from ratestate.dynamics.cycles.shooting import return_map
from ratestate.dynamics.cycles.system import system_of
from ratestate.model.user_laws import known_again
known_again({record!r})
one = np.ones(1)
own = dict.fromkeys({own!r}, one)
common = dict(a=one, b=2.0 * one, Dc=one, sigma=one, K=0.5 * one, M=one, V_lp=one)
system = system_of({law!r}, **common, **own)
return_map(system, np.full((1, {n}), 0.1), 1e-3)
"""


def compile_cycles_elsewhere(law):
    """Let another process compile what `limit_cycle` needs, which then waits for it.

    Without effect where that is compiled already, and for a user's class of laws, which has no file
    that the other process could run.  ParameterError for an unknown law.

    law : str, name of a friction law, or of one composed (`composition`)
    """
    if statement := any_return(law):
        compile_elsewhere(march_to_section, composed_law(law), statement)


def any_return(law):
    """The statement of one return under a law; "" for a user's class of laws."""
    friction = composed_law(law)
    record = recorded(own_name(friction.name))
    if not (record is None or isinstance(record, str)):
        return ""
    own, n = [*friction.parameters, *friction.of_slider], 2 + len(friction.states)
    return ANY_RETURN.format(law=friction.name, record=record, own=own, n=n)
