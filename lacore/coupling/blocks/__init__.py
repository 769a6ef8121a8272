"""Rigid blocks, in the plane and in space: paths to their states, mechanisms up to a slack."""
