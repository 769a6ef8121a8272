"""The words of verdicts, as rows and findings have them."""

PASS, FAIL, SKIPPED, NO_RESULT = "pass", "FAIL", "skipped", "no result"
NO_REFERENCE = "no reference"
"""Of what is proven, and cannot be compared with anything: neither right nor wrong."""
