"""Simulation, limit cycles, branches and basins of sliders, and how results record them."""
