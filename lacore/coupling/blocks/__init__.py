"""Rigid blocks in two and three dimensions: central paths, and slack of mechanisms."""
