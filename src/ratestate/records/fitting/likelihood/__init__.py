"""Inference from the likelihood: intervals, profiles, posterior.

===================== ==========================================================================
``quantities``        the reported quantities, as functions of the coordinates
``inference``         estimates with errors and intervals
``profile``           profiles of the likelihood along one reported quantity
``posterior``         prior, samples and evidence, and whether they are reliable
``marginal``          `log_likelihood`, with level and trend integrated out
``noise_uncertainty`` how the uncertainty of the noise widens intervals
``transients``        a test whether the law fits, by the residuals after steps
===================== ==========================================================================
"""
