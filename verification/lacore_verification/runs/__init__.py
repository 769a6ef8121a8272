"""Runs and their results as plain data."""
