"""The part of the solver that finds limit cycles, compiled while this process runs another."""

from ...engine.compilation import compile_elsewhere
from ...engine.return_map import march_to_section
from ...friction.laws import evolution_law

ANY_CYCLE = """
import ratestate as rs
slider = rs.SpringSlider(a=0.01, b=0.015, Dc=1e-5, sigma=1e7, K=4e9, law={law!r})
rs.limit_cycle(slider.replace(M=1e3), 1e-3)
"""


def compile_cycles_elsewhere(law):
    """Let another process compile what `limit_cycle` needs, which then waits for it.

    Without effect where that is compiled already.  ParameterError for an unknown law.

    law : str, name of an evolution law
    """
    compile_elsewhere(march_to_section, evolution_law(law), ANY_CYCLE.format(law=law))
