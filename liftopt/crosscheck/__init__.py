"""Independent checks, which no solve imports.

Of the dynamics: the paper's own equations (recursive Lagrangian, eqs. 1-9, Fig. 2). Of a solved lift: MuJoCo's inverse
and forward dynamics, the energy balance, and a second transcription (Hermite-Simpson).
"""
