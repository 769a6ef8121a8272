"""Bodies of three kinds, and which of their edges touch."""
