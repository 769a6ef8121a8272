"""Builders of blocks in space."""
