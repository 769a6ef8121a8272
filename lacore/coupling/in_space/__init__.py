"""Loops and searches of blocks in space: curves, proximal steps, mechanisms up to a slack."""
