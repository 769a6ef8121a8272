"""Stresses of a solver made admissible: equilibrium, strengths, friction (T26c)."""
