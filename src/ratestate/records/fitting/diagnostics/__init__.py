"""Notes and warnings on a fit; `checks.diagnose` gives all of them, in order.

=================== =====================================================================
``checks``          search, posterior, misfit, trend, normal stress, end of the record
``identifiability`` parameters that a record determines, and parameters that trade off
``left_out``        a spring, a lag or inertia that the record shows and the slider lacks
=================== =====================================================================
"""
