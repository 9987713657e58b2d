"""Notes on a fit: warnings, identifiability of the parameters, comparison of the laws.

==================== ======================================================================
``checks``           `diagnose`: all warnings in order; normal stress
``misfit``           whether the law fits
``trend``            how much the estimates depend on the trend of friction
``left_out``         a spring, a lag or inertia that the record shows and the slider has not
``identifiability``  which parameters a record determines
``tradeoffs``        which parameters trade off, and what combination is determined
``search``           whether the search converged, and the posterior is reliable
``model_comparison`` which law is preferred, and how clearly
==================== ======================================================================

Sentences are in the TOML file of a module's name.
"""
