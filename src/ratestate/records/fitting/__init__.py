"""Fits of laboratory records: the function `fit` and its parts.

A fit goes through one code, whatever is fitted: a forward model (`forward`, `cycles.problem`),
whitened residuals (`problem`), search and covariance (`solutions`), intervals
(`inference`), warnings (`checks`) and the Dataset (`fit_dataset`).
"""
