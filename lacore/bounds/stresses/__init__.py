"""Projection of a solver's stresses onto admissible ones.

Equilibrium, strength, friction (T26c).
"""
