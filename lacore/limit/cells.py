"""Cells that stand for joints that crush: from below they carry no more than joints do (T95)."""

from collections.abc import Mapping
from dataclasses import replace

from lacore.bodies.any_body import of_kind
from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.bodies.blocks3d.crushing import Crushing, crushing_of
from lacore.problem.problem import Problem
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.status import Status


def laws_of_crushing(problem: Problem) -> dict[str, Crushing]:
    """By assembly, those whose joints crush."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    return {name: law for name, own in solids.items() if (law := crushing_of(own.crushing))}


def from_below(problem: Problem) -> bool:
    """Whether there are cells that carry no more than their joints."""
    return any(law.side == "below" for law in laws_of_crushing(problem).values())


def fall_of_cells(problem: Problem, status: Status) -> Finding | None:
    """Return that UNSAFE is proven of cells that carry less than their joints; else None."""
    return Finding(Kind.CELLS_FALL) if status is Status.UNSAFE and from_below(problem) else None


def with_cells(problem: Problem, laws: Mapping[str, Crushing], side: str) -> Problem:
    """The problem with these cells, on one side."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    cut = {name: solids[name].crushed(replace(law, side=side)) for name, law in laws.items()}
    return replace(problem, bodies={**problem.bodies, **cut})
