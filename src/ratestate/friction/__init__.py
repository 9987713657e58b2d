"""Friction laws, and the stability of steady sliding.

A law (`law_formula`, `law`) is a formula.  `equations` runs it once with `expressions`, and
`motion` derives the equations of motion.  docs/developer/engine.md explains how they become code.
"""
