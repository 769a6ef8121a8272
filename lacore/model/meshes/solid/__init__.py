"""Meshes of tetrahedra: builders and checks."""
