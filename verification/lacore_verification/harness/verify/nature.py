"""What a problem is like, before it is solved: which sides its values must lie on."""

from dataclasses import dataclass

import lacore as la
from lacore.limit.outcome import strict_bound
from lacore.solvers.child_process import START, ChildProcess
from lacore_verification.case import Case, Variant, is_of_lacore

_WORKER = "lacore_verification.harness.verify.nature:Worker"


@dataclass(frozen=True)
class Nature:
    """Of a problem.

    Attributes:
        strict: whether the dissipation is an upper bound.
        normal: whether all flow is associated, that of soils and of contact.
        bounded: whether that of soils is, so that bounds enclose every load factor.
        ranged: whether that of soils is not, so that there may be many.
    """

    strict: bool = False
    normal: bool = False
    bounded: bool = False
    ranged: bool = False


class Worker:
    """In a process of its own."""

    def nature(self, case: Case, variant: Variant, mesh: str) -> Nature:
        """Of a problem, built here."""
        found = la.discretise(case.problem(variant, mesh))
        bounded = not found.full.frictional
        normal = bounded and not found.full.contact.coulomb.any()
        return Nature(strict_bound(found), normal, bounded, not bounded)


def nature_of(case: Case, variant: Variant, mesh: str) -> Nature:
    """Of a variant; of one that cannot be built nothing is known, and its rows will say why.

    What others wrote is built in a process of its own: it may hang, or end it.
    """
    try:
        if is_of_lacore(case):
            return Worker().nature(case, variant, mesh)
        with ChildProcess(_WORKER) as process:
            nature: Nature = process.ask(START, "nature", case, variant, mesh)
            return nature
    except Exception:  # lost processes, and whatever others wrote
        return Nature()
