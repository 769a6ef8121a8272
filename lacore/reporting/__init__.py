"""Texts whose numbers and names are values, rendered for Python users or users of problem files."""
