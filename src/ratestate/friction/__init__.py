"""Friction laws, and the stability of steady sliding.

A law (`law_formula`, `law`) is a formula.  `equations` runs it once with `expressions`.
`equations_of_motion` and `point` follow from it.  docs/developer/engine.md explains how.
"""
