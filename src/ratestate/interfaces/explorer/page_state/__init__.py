"""What the page's entries describe: a slider, speeds and an experiment.

============ =================================================
``typed``    a typed text as a value
``protocol`` the segments of a protocol, as text and back
``state``    a slider, speeds and an experiment
``entries``  from typed entries to such a state, and back
============ =================================================
"""
