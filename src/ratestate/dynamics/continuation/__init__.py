"""Branches of limit cycles, their bifurcations, and cycles beside stable steady sliding."""
