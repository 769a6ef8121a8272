"""Loops on contact reactions, on programs alone (T9-T14)."""
