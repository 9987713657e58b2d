"""Branches of limit cycles, their bifurcations, and the basin of steady sliding."""
