"""States, brackets and paths as bytes, and back: so that a stored number can be proven again."""
