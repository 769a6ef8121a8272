"""Bounds of bodies of tetrahedra: what is theirs alone."""
