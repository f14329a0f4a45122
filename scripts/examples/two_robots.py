"""
two_robots
====================

To come.
"""
