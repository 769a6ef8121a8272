"""Verification: cases with references, and the harness that compares backends with them."""

from verification.results import load_results

__all__ = ["load_results"]
