"""Stiffness, mass and damping of a machine."""
