"""Loads and supports, and the part of a boundary that they act on."""
