"""Bounds of bodies of tetrahedra."""
