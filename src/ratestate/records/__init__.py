"""Laboratory records: read, fitted and evaluated.

================= ============================================================================
``reading``       a laboratory's file as a Dataset, with the load point's steps and holds
``fitting``       such a Dataset and a slider: parameters, their errors, warnings
``healing``       frictional healing in slide-hold-slide tests
``stick_slip``    the catalogue of stick-slip events in a record or a run
``machine``       stiffness, mass and damping of the machine
``load_point``    the load point's segments, and its displacement
``regression``    linear regression: of correlated samples, and of estimates with errors
``sample_noise``  the noise of a series from sample to sample
``text_table``    a table of texts as lines
``child_process`` work spread over processes
================= ============================================================================
"""
