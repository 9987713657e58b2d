"""What every evaluation of a record uses.

====================== ==========================================================================
``noise``              level and correlation of the noise, as a user gives it; whitening
``estimated_noise``    these from residuals, by restricted maximum likelihood
``sample_noise``       the noise of a series from sample to sample, and its resolution
``regression``         linear regression, of samples and of estimates with errors; derivatives
``least_squares``      least squares within bounds; BLAS on one thread
``polynomial_windows`` polynomials in windows of a record, and how far such windows go
``processes``          work spread over child processes; files read in one, under limits
``results``            variables of results, and their tables as text
====================== ==========================================================================
"""
