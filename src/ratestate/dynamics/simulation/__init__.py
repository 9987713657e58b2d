"""Motion under any loading, step by step.

=============== ================================================================================
``simulate``    `simulate` and its checked call: a start at rest, and results beyond memory, refused
``settings``    range of rtol, methods, varying normal stress, times that can be saved
``undisturbed`` which runs start on unstable steady sliding, and stay there
``cases``       V at which a run without mass counts as runaway, most steps of a run, which
                exception stands for which status
``motion``      runs of a batch, and their results in SI: which amplitude counts as a cycle, what
                is NaN
``loads``       speed and normal stress of a loading, as tables for the engine; whether it rests
=============== ================================================================================
"""
