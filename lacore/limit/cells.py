"""Strengths that are approximated from below or above: cells of crushing joints, section polygons.

From below cells carry no more than joints do (T95), and polygons inside no more than sections.
"""

from collections.abc import Mapping
from dataclasses import replace

from lacore.model.bodies.any_body import AnyBody, of_kind
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.crushing import Crushing, crushing_of
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.section import INNER, OUTER, Section
from lacore.model.problem.problem import Problem
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status

_POLYGONS = {"below": INNER, "above": OUTER}


def laws_of_crushing(problem: Problem) -> dict[str, Crushing]:
    """By assembly, those whose joints crush."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    return {name: law for name, own in solids.items() if (law := crushing_of(own.crushing))}


def from_below(problem: Problem) -> bool:
    """Whether cells or polygons carry no more than their joints or sections, and maybe less."""
    return _approximated(problem, "below")


def from_above(problem: Problem) -> bool:
    """Whether cells or polygons carry no less than their joints or sections, and maybe more."""
    return _approximated(problem, "above")


def _approximated(problem: Problem, side: str) -> bool:
    frames = of_kind(problem.bodies, Frame).values()
    return any(law.side == side for law in laws_of_crushing(problem).values()) or any(
        _POLYGONS[side] in own.polygons for own in frames
    )


def fall_of_cells(problem: Problem, status: Status) -> Finding | None:
    """Return that UNSAFE is proven of cells or polygons that carry less; else None."""
    if status is not Status.UNSAFE or not from_below(problem):
        return None
    crushes = any(law.side == "below" for law in laws_of_crushing(problem).values())
    return Finding(Kind.CELLS_FALL if crushes else Kind.POLYGONS_FALL)


def with_cells(problem: Problem, laws: Mapping[str, Crushing], side: str) -> Problem:
    """The problem with these cells, on one side."""
    solids = of_kind(problem.bodies, BlockAssembly3D)
    cut = {name: solids[name].crushed(replace(law, side=side)) for name, law in laws.items()}
    return replace(problem, bodies={**problem.bodies, **cut})


def on_side(problem: Problem, side: str) -> Problem:
    """The problem with all cells and polygons ``below`` or ``above`` what they approximate."""
    problem = with_cells(problem, laws_of_crushing(problem), side)
    frames: dict[str, AnyBody] = {
        name: replace(own, sections=_sections(own, _POLYGONS[side]))
        for name, own in of_kind(problem.bodies, Frame).items()
        if own.polygons
    }
    return replace(problem, bodies={**problem.bodies, **frames})


def _sections(frame: Frame, side: str) -> Section | dict[str, Section] | None:
    given = frame.sections
    if isinstance(given, Mapping):
        return {name: own.on_side(side) for name, own in given.items()}
    return None if given is None else given.on_side(side)
