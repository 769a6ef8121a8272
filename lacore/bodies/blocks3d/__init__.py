"""Assemblies of rigid blocks in space: polyhedra, the joints between them, their unknowns."""
