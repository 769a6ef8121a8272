"""Conformance suite: small programs with analytical solutions that every backend must solve.

`run` returns a table of findings on a backend, `require` raises if one failed::

    from lacore_verification import conformance

    def test_my_backend():
        conformance.require("mine")
"""

from lacore_verification.conformance.contract import EXERCISES
from lacore_verification.conformance.judge import FAIL, PASS, SKIPPED
from lacore_verification.conformance.suite import by_program, failures, records, require, run

__all__ = [
    "EXERCISES",
    "FAIL",
    "PASS",
    "SKIPPED",
    "by_program",
    "failures",
    "records",
    "require",
    "run",
]
