"""Sketch of a problem: its shape, loads, supports and names."""
