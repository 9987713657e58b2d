"""Tools that the evaluations of records share.

====================== ==========================================================================
``noise``              level and correlation of the noise, given by the user; whitening
``estimated_noise``    noise estimated from residuals, by restricted maximum likelihood
``sample_noise``       noise between neighbouring samples of a series, and its resolution
``regression``         linear regression of samples, and of estimates with errors; derivatives
``least_squares``      nonlinear least squares within bounds; BLAS on one thread
``polynomial_windows`` polynomials in windows of a record, and the sizes of these windows
``processes``          parallel work in child processes; reading files in a limited child process
``results``            variables of results, and their tables as text
====================== ==========================================================================
"""
