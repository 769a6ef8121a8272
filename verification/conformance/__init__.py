"""The conformance suite: small programs solved by hand that every backend must get right.

`run` gives a table of findings on a backend, `require` raises where one failed::

    from verification import conformance

    def test_my_backend():
        conformance.require("mine")
"""

from verification.conformance.contract import EXERCISES
from verification.conformance.judge import FAIL, PASS, SKIPPED
from verification.conformance.suite import by_program, failures, records, require, run

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
