"""Plane frames: members, plastic hinges, unknowns."""
