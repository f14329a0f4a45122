"""The paper's own equations (recursive Lagrangian, eqs. 1-9, Fig. 2) as a check on Pinocchio; no solve imports this."""
