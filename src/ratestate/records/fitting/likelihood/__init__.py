"""What the likelihood says of each estimate: profiles, posterior, intervals.

===================== ==========================================================================
``inference``         what is reported, with the source of each interval
``profile``           profiles of the likelihood, with one reported quantity constrained
``posterior``         the prior, samples, evidence, and whether they are reliable
``marginal``          `log_likelihood`, with level and trend integrated out
``noise_uncertainty`` what the uncertainty of the noise adds to that of estimates
``transients``        what residuals show after steps: whether the law fits
===================== ==========================================================================
"""
