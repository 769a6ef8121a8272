"""Quadratic stresses of lower bounds for body forces that vary in elements (T86)."""
