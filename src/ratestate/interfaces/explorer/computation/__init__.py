"""What is computed for such a state, each part with a time limit.

============== ===============================================================================
``budget``     the time limit
``motion``     which run is shown, and for how long
``settled``    the motion that has settled before an experiment
``experiment`` which run shows an experiment
``picture``    what is drawn: run, limit cycle, steady point, verdict
``marks``      the critical values on the page's sliders
``charts``     what is behind the map: K_c, the atlas, finer parts; which sliders share them
``branch``     the bifurcation diagram: its range, stability, and branches of limit cycles
``decimation`` which points of a long curve are sent
============== ===============================================================================
"""
