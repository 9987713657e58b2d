"""What a record tells of each parameter, in words."""


def identified(solution, found):
    """Words on what is determined, and warnings (list of str)."""
    problems = []
    if not solution.converged:
        problems.append("the least squares have not converged")
    for name in solution.unknowns.names:
        if solution.at_bound(name):
            problems.append(f"{name} has run to a bound")
    return "", problems
