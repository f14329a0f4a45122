"""What a solution means: three verdicts (the mathematics, the person, the robot) and the findings they rest on.

Terminal, ``--json``, report, ``solution.nc`` and Python tell the same list, made once by ``assess``.
"""
