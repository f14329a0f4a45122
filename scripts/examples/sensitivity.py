"""
sensitivity
====================

To come.
"""
