"""Cells that stand for joints that crush: from below they carry no more than joints do (T95)."""

from collections.abc import Mapping
from dataclasses import replace

from lacore.bodies.any_body import of_kind
from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.bodies.blocks3d.crushing import Crushing, crushing_of
from lacore.problem.problem import Problem
from lacore.status import Status

_FALLS = (
    "of the cells of joints that crush: the joints carry more than these, finer ones"
    " (lacore.Crushing, divisions) say how much"
)


def laws_of_crushing(problem: Problem) -> dict[str, Crushing]:
    """By assembly, those whose joints crush."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    return {name: law for name, own in solids.items() if (law := crushing_of(own.crushing))}


def from_below(problem: Problem) -> bool:
    """Whether there are cells that carry no more than their joints."""
    return any(law.side == "below" for law in laws_of_crushing(problem).values())


def told_of_fall(problem: Problem, status: Status) -> str:
    """What UNSAFE is said of, where that is cells from below; else empty."""
    return _FALLS if status is Status.UNSAFE and from_below(problem) else ""


def with_cells(problem: Problem, laws: Mapping[str, Crushing], side: str) -> Problem:
    """The problem with these cells, on one side."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    cut = {name: solids[name].crushed(replace(law, side=side)) for name, law in laws.items()}
    return replace(problem, bodies={**problem.bodies, **cut})
