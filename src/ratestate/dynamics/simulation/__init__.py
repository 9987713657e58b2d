"""Motion under any loading, step by step.

=============== ================================================================================
``simulate``    `simulate` and its checked call: a start at rest, and results beyond memory, refused
``settings``    range of rtol, which method needs what, how long dt may be, which times can be saved
``undisturbed`` which runs start on unstable steady sliding, and stay there
``cases``       V at which a run without mass counts as runaway, most steps of a run, which
                exception stands for which status
``motion``      runs of a batch, and their results in SI: which amplitude counts as a cycle, what
                is NaN
``loads``       speed and normal stress of a loading, as tables for the engine
``rigid``       K = inf: ``rigid_path`` has the motion, ``rigid_times`` when it is shown,
                ``rigid_extremes`` the smallest friction and stress in it
=============== ================================================================================
"""
