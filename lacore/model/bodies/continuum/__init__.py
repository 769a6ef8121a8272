"""Deformable bodies: mesh, velocity space, unknowns, dissipation."""
