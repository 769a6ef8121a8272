"""The installed backend passes lacore's conformance suite."""

from lacore_verification import conformance


def test_conformance() -> None:
    """One call: programs with known answers, wrong ones, limits; says which one failed and how."""
    conformance.require("ecos")
