"""Laboratory records: read, fitted and evaluated.

================= ============================================================================
``reading``       a laboratory's file as a Dataset, with the load point's steps and holds
``load_point``    these steps and holds, found in a displacement
``raw_record``    the columns of such a Dataset, checked
``loading``       the speeds of its load point and its normal stress
``fitting``       parameters of a slider from a record, their errors, warnings
``healing``       frictional healing in slide-hold-slide tests
``stick_slip``    the catalogue of stick-slip events in a record or a run
``machine``       stiffness, mass and damping of the machine
``kit``           noise, regression, least squares and polynomials for all of these
``messages``      their sentences
================= ============================================================================
"""
