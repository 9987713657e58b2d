"""Fits of laboratory records: the verb `fit` and what it is made of."""
