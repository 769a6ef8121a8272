"""Judges of limit states: pure functions that find what a load factor does not show."""
