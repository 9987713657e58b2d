"""Limit cycles: which attractor is reached, its measures with their errors, and its regime."""
