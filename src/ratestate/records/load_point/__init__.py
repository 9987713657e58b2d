"""Segments of constant speed, holds and steps of normal stress, found in a record.

=================== ==========================================================================
``segments``        `find_segments`: constant speeds, their errors; steps in words
``steps``           which cuts are steps; what is a hold, a jump, a ramp
``stress_steps``    steps of normal stress
``splits``          where rows are cut into runs
``runs``            lines through runs, and where they meet
=================== ==========================================================================
"""
