"""Regions of a body: parts of its mesh with one criterion each, and their varying fields."""
