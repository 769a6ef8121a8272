"""Shared parts of cases with non-associated soil."""

UNFIT = {
    "regularised": "their loop iterates on contact reactions alone, and here friction is inside of"
    " the soil"
}
"""Backends that cannot do them, and why: `Variant.unfit`."""
