"""Loads and supports, and the parts of a boundary that they act on."""
