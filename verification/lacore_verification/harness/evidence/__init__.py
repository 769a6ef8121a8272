"""Serialisation of states, brackets and paths, so that a stored number can be proven again."""
