"""Quadratic stresses beside the linear ones of lower bounds: what varies in elements (T86)."""
