"""Regions of a body: parts of its mesh with a criterion each, and what varies within them."""
