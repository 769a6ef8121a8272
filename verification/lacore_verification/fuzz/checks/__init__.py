"""Checks of a state by code that is independent of the solver."""
