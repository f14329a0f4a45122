"""Solver adapters: one module each, all with the same call."""
