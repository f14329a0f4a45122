"""How a command ends, for the shell: these, and 130 where it was interrupted."""

DONE = 0  # solved and verified, all checks passed, written
BAD_INPUT = 2
NOT_SOLVED = 3  # no verified solution, or a check failed
