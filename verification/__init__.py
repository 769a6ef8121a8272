"""Verification: cases with references, and the harness that compares backends with them."""
