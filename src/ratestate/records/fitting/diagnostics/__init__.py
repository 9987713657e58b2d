"""Notes on a fit: `checks.diagnose` gives all warnings, in order.

=================== =====================================================================
``checks``          search, posterior, misfit, trend, normal stress, the record's end
``identifiability`` which parameters a record determines, and which trade off
``left_out``        a spring, a lag or inertia that the record shows and the slider lacks
=================== =====================================================================
"""
