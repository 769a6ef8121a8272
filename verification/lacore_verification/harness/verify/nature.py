"""Nature of a problem, before it is solved: the required sides of its values."""

from dataclasses import dataclass

import lacore as la
from lacore.limit.outcome import strict_bound
from lacore.solvers.child_process import START, ChildProcess
from lacore_verification.case import Case, Variant, is_of_lacore

_WORKER = "lacore_verification.harness.verify.nature:Worker"


@dataclass(frozen=True)
class Nature:
    """Nature of a problem.

    Attributes:
        strict: whether the dissipation is an upper bound.
        normal: whether all flow is associated, that of soils and of contact.
        bounded: whether that of soils is, so that bounds enclose every load factor.
        ranged: whether that of soils is not, so that load factors may not be unique.
    """

    strict: bool = False
    normal: bool = False
    bounded: bool = False
    ranged: bool = False


class Worker:
    """Worker in a separate process."""

    def nature(self, case: Case, variant: Variant, mesh: str) -> Nature:
        """Return the nature of a problem, which is built here."""
        found = la.discretise(case.problem(variant, mesh))
        bounded = not found.full.frictional
        normal = bounded and not found.full.contact.coulomb.any()
        return Nature(strict_bound(found), normal, bounded, not bounded)


def nature_of(case: Case, variant: Variant, mesh: str) -> Nature:
    """Return the nature of a variant.

    It is unknown if the variant cannot be built, which rows report.

    Cases of users are built in a separate process, as they may hang, or end it.
    """
    try:
        if is_of_lacore(case):
            return Worker().nature(case, variant, mesh)
        with ChildProcess(_WORKER) as process:
            nature: Nature = process.ask(START, "nature", case, variant, mesh)
            return nature
    except Exception:  # Lost processes, and any error of cases of users.
        return Nature()
