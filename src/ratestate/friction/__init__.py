"""Friction and the stability of steady sliding: laws, closed forms, eigenvalues, normal form."""
