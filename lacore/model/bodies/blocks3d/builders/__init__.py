"""Builders of three-dimensional blocks."""
