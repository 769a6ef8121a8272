"""The words of verdicts, as rows and findings have them."""

PASS, FAIL, SKIPPED, NO_RESULT = "pass", "FAIL", "skipped", "no result"
NO_REFERENCE = "no reference"
"""Of what is proven, and cannot be compared with anything: neither right nor wrong."""
BOUND_ONLY = "bound only"
"""Of another model than that of the case: it is on the right side of the reference.

Its own load factor is not known, so that it may be far from the reference: a comparison of models,
not a check of a number.
"""
