"""Friction and the stability of steady sliding: laws, closed forms, runaway without inertia."""
