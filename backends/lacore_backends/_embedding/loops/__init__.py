"""Loops over points and elements, with and without numba."""
