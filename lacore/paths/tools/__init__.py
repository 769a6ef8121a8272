"""Rigid tools of a path: what a user states, the body that moves, and where it meets others."""
