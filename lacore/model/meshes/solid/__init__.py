"""Meshes of tetrahedra: made, checked."""
