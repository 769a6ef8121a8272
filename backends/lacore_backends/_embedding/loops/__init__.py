"""What is done point by point and element by element, with numba and without it."""
