"""What a slider does: motions, limit cycles, branches of them, basins; how results say so."""
