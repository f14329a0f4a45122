"""What a solution means: four verdicts (person, robot, clearance, mathematics) and the findings they rest on.

Terminal, ``--json``, report, ``solution.nc`` and Python tell the same list, made once by ``assess``.
"""
