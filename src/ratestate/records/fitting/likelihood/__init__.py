"""What the likelihood says of each estimate: profiles, posterior, intervals.

===================== ==========================================================================
``quantities``        what is reported, as functions of the coordinates
``inference``         its errors and intervals, with their source
``profile``           profiles of the likelihood, with one reported quantity held
``posterior``         the prior, samples, evidence, and whether they are reliable
``marginal``          `log_likelihood`, with level and trend integrated out
``noise_uncertainty`` what the uncertainty of the noise adds to that of estimates
``transients``        what residuals show after steps: whether the law fits
===================== ==========================================================================
"""
