"""Find segments of constant speed, holds and steps of normal stress in a record.

=================== ==========================================================================
``segments``        `find_segments`: constant speeds and their errors; steps in words
``classification``  decides which cuts are steps, holds, jumps or ramps
``stress_steps``    steps of normal stress
``splits``          cuts the rows into runs
``runs``            lines through runs, and their intersections
=================== ==========================================================================
"""
