"""What a slider does: motions, limit cycles, branches and basins, and how results record it."""
