"""Compiled code of the dynamics and their derivatives, made with CasADi and kept."""
