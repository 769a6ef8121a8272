"""Checks that apply to every case, the same for `lacore verify` and for pytest.

`ask` makes the questions, each with the runs that it needs; `finish` collects the data from their
outcomes; `answer` gives the `Finding` of one question.
"""

from lacore_verification.harness.verify.answers import Finished, answer, finish
from lacore_verification.harness.verify.finding import FILE, Finding, as_table, load_checks, tally
from lacore_verification.harness.verify.questions import CHECKS, Question, ask, left_out, runs_of

__all__ = [
    "CHECKS",
    "FILE",
    "Finding",
    "Finished",
    "Question",
    "answer",
    "as_table",
    "ask",
    "finish",
    "left_out",
    "load_checks",
    "runs_of",
    "tally",
]
