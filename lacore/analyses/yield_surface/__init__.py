"""Combinations of loads that are carried: convex sets between points and planes (T82)."""
