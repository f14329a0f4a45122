"""From a scenario to a solution: initial guesses, coarse search, variations, mesh refinement, suggested changes."""
