"""
two_people
====================

To come.
"""
