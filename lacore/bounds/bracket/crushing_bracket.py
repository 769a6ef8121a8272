"""Load factors of crushing joints between bounds, by cells that follow the mechanism (T95)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np
import pandas as pd
import shapely

from lacore.bounds.constants import CUT_SHARE, CUTS_BY_MECHANISM, HALVINGS, LEAST_CELL
from lacore.limit.cells import laws_of_crushing, with_cells
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.crushing import Cells, Crushing
from lacore.model.bodies.blocks3d.surface import axes_of
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.reporting.errors import InputError, require_count, require_width, typed
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Facts, Picture, counted
from lacore.reporting.status import Reported, Status
from lacore.reporting.text import PYTHON


@dataclass(frozen=True, repr=False)
class CrushingBracket(Reported):
    """Bounds of the load factor of joints that crush, with associated friction (T95).

    No Coulomb load factor of these joints exceeds `high` either (T14).

    Attributes:
        status: SOLVED if both bounds are certified; UNSAFE if joints with the larger strengths do
            not carry the dead loads.
        low, high: NaN if nothing is certified.
        lower, upper: the states that prove them.
        problem: problem with the cells of `low`: `lacore.solve` finds Coulomb states with them.
        rounds: one row per iteration: cells, low, high.
    """

    status: Status
    low: float
    high: float
    lower: LimitState
    upper: LimitState
    problem: Problem
    rounds: pd.DataFrame

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Those of the state with the status of the bracket: of the lower one if it proves less."""
        return (self.upper if self.upper.status is self.status else self.lower).findings

    @property
    def width(self) -> float:
        """``(high - low)/high``."""
        return (self.high - self.low) / self.high if self.high else nan

    def facts(self) -> Facts:
        """Return the proven bounds, for printing."""
        told = {
            "status": self.report.summary_for(PYTHON),
            "rounds": f"{counted(len(self.rounds), 'round')}, {self.lower.discretisation.contents}",
        }
        title = f"CrushingBracket: load factor in [{self.low:.7g}, {self.high:.7g}]"
        return Facts(title, told)

    def picture(self) -> Picture:
        """Return the mechanism of the upper bound."""
        return self.upper.picture()


@typed()
def crushing_bracket(
    problem: Problem, backend: str = "auto", *, target_width: float = 5e-3, rounds: int = 12
) -> CrushingBracket:
    """Compute bounds of the associated load factor of crushing joints, on refined cells (T95).

    Args:
        problem: problem with three-dimensional blocks that have `crushing`; begin with one
            division.
        backend: name of an exact backend.
        target_width: value of ``(high - low)/high`` at which to stop.
        rounds: largest number of iterations with two solves each.

    Raises:
        InputError: no blocks that crush, or an invalid width.

    Example:
        >>> weak, size = la.Crushing(1e5, divisions=1), (0.4, 0.2, 1.0)
        >>> blocks = la.masonry3d.wall([[1]], friction=0.7, block=size, crushing=weak)
        >>> pushed = la.Problem(
        ...     bodies={"pier": blocks},
        ...     supports=[la.Fix("pier", "base")],
        ...     dead_loads=[la.BodyForce("pier", (0, 0, -20e3))],
        ...     reference_loads=[la.BodyForce("pier", (20e3, 0, 0))],
        ... )
        >>> found = la.crushing_bracket(pushed, target_width=1e-5)
        >>> round(found.low, 3), round(found.high, 3)  # (0.4 m - 0.08 m)/1 m
        (0.32, 0.32)
    """
    require_width("crushing_bracket.target_width", target_width)
    require_count("crushing_bracket.rounds", rounds)
    laws = laws_of_crushing(problem)
    if not laws:
        fix = "give lacore.BlockAssembly3D(..., crushing=strength in Pa)"
        raise InputError("crushing_bracket.problem", None, "no joint of it crushes", fix)
    rows, kept, lower, upper = [], problem, None, None
    for number in range(rounds):
        stated = with_cells(problem, laws, "below")
        under = solve(stated, backend, coupling="associated")
        over = solve(with_cells(problem, laws, "above"), backend, coupling="associated")
        if lower is None or _proven(under, -inf) > _proven(lower, -inf):
            lower, kept = under, stated
        if upper is None or _proven(over, inf) < _proven(upper, inf):
            upper = over
        bodies = of_kind(stated.bodies, BlockAssembly3D)
        count = sum(bodies[name].joints.weight.size for name in laws)
        rows.append({"cells": count, "low": under.load_factor, "high": over.load_factor})
        low, high = _proven(lower, -inf), _proven(upper, inf)
        if under.point is None or over.point is None or over.status is Status.UNSAFE:
            break
        if high - low <= target_width * abs(high):
            break
        halved = number >= CUTS_BY_MECHANISM and number % 2 == 1
        laws = {
            name: replace(law, cells=_finer(bodies[name], name, law, (under, over), halved))
            for name, law in laws.items()
        }
    assert lower is not None  # of the first iteration
    assert upper is not None
    status = upper.status
    # The problem of the cells alone is UNSAFE as well.
    if status is Status.SOLVED and lower.status is not status:
        status = Status.NOT_CERTIFIED
    known = lower.load_factor, upper.load_factor
    return CrushingBracket(status, *known, lower, upper, kept, pd.DataFrame(rows))


def _proven(state: LimitState, otherwise: float) -> float:
    """Return the load factor of a state if it is certified."""
    return otherwise if np.isnan(state.load_factor) else state.load_factor


def _finer(
    body: BlockAssembly3D,
    name: str,
    law: Crushing,
    states: Sequence[LimitState],
    halved: bool,
) -> Cells:
    """Return the cells of an assembly, cut where mechanisms crush a part of them.

    Args:
        body: an assembly.
        name: its name in the problem.
        law: strength of its joints.
        states: states with uniform pressure in its cells, and with their strength at corners.
        halved: whether cells are halved instead of cut where mechanisms crush them.
    """
    own = body.joints.cells
    assert own is not None
    joint, cell, area, middle = own.joint, own.cell, own.area, own.centroid
    axes = np.stack(axes_of(body.joints.normal))[:, :, joint]
    flat = np.einsum("axk,xk->ak", axes[:, :, cell], own.corners - middle[:, cell])
    seen = [_crushing(body, state.velocity[name], own, axes) for state in states]
    rims, mids, ways = (np.stack(values) for values in zip(*seen, strict=True))
    thirds = [np.bincount(cell, own.corner_area * np.maximum(rim, 0.0)) for rim in rims]
    lacking = np.array(thirds) - area * np.maximum(mids, 0.0)
    order = np.argsort(-lacking.max(axis=0))
    total = np.cumsum(lacking.max(axis=0)[order])
    marked = np.sort(order[: np.searchsorted(total, CUT_SHARE * total[-1]) + 1])

    # A cell that is partly at its strength has that part cut off; others are cut where a mechanism
    # closes them.
    assert states[0].point is not None  # Its motion is known, so there is a point.
    (stress,) = (
        part[:, 0]
        for group, part in zip(
            states[0].discretisation.full.groups, states[0].point.stress, strict=True
        )
        if group.name == f"{name}: crushing"
    )
    filled = stress / law.strength
    begin = np.searchsorted(cell, np.arange(joint.size))
    turns = np.minimum.reduceat(rims, begin, axis=1) < 0
    turns &= (np.maximum.reduceat(rims, begin, axis=1) > 0) & (not halved)
    partly = turns[0] & (filled > LEAST_CELL) & (filled < 1 - LEAST_CELL)
    which = np.where(partly, 0, lacking.argmax(axis=0))
    every = np.arange(joint.size)
    way, turned = ways[which, :, every].T, turns[which, every]
    steep = np.linalg.norm(way, axis=0)
    spread = np.stack([np.bincount(cell, a * b) for a in flat for b in flat]).T.reshape(-1, 2, 2)
    long = np.linalg.eigh(spread).eigenvectors[:, :, 1].T
    way = np.where(turned, way / np.where(steep > 0, steep, 1.0), long)
    at = np.where(turned, -mids[which, every] / np.where(steep > 0, steep, 1.0), 0.0)
    return _split(own, axes, flat, marked, way, at, np.where(partly, filled, np.nan))


def _crushing(
    body: BlockAssembly3D, motion: Floats, own: Cells, axes: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return the crushing rates of cells at corners, (k,), and centroids, (c,), m/s.

    Rates are positive where cells crush. The third value is the slope of the rate at centroids in
    the axes of the joints, (2, c), 1/s.
    """
    joints = body.joints
    slope = body.joint_terms[0] + body.joint_terms[2]

    def rate(places: Floats, joint: Ints) -> tuple[Floats, Floats]:
        normal, jump = joints.normal[:, joint], np.zeros_like(places)
        for sign, side in ((1, joints.slave), (-1, joints.master)):
            arm = places - body.centroid[:, side[joint]]
            turning = np.cross(motion[3:, side[joint]], arm, axis=0)
            jump += sign * (motion[:3, side[joint]] + turning)
        opening = np.sum(jump * normal, axis=0)
        slip = jump - opening * normal
        return slope[joint] * np.linalg.norm(slip, axis=0) - opening, slip

    at_corners, _ = rate(own.corners, own.joint[own.cell])
    at_middle, slip = rate(own.centroid, own.joint)
    size = np.linalg.norm(slip, axis=0)
    ahead = slope[own.joint] * slip / np.where(size > 0, size, 1.0) - joints.normal[:, own.joint]
    spin = (motion[3:, joints.slave] - motion[3:, joints.master])[:, own.joint]
    along = np.stack([np.sum(ahead * np.cross(spin, axis, axis=0), axis=0) for axis in axes])
    return at_corners, at_middle, along


def _split(
    own: Cells,
    axes: Floats,
    flat: Floats,
    marked: Ints,
    way: Floats,
    at: Floats,
    share: Floats,
) -> Cells:
    """Return the cells, with marked ones cut across `way`.

    Args:
        own: all cells.
        axes: axes of their joints, (2, 3, c).
        flat: corners from centroids in these axes, (2, k), m.
        marked: cells to cut, ascending.
        way: directions, (2, c).
        at: distances of the cuts from centroids, (c,), m.
        share: share of the area to cut off ahead, instead of `at`, (c,); NaN to use `at`.
    """
    rim = np.flatnonzero(np.isin(own.cell, marked))
    number = np.searchsorted(marked, own.cell[rim])
    whole = shapely.polygons(shapely.linearrings(flat[:, rim].T, indices=number))
    reach = np.zeros(marked.size)
    np.maximum.at(reach, number, 2 * np.linalg.norm(flat[:, rim], axis=0))

    def ahead(at: Floats, way: Floats) -> Geometries:
        across = np.stack([-way[1], way[0]])
        near, far = at * way, (at + 2 * reach) * way
        ends = (near - reach * across, near + reach * across, far + reach * across)
        rings = np.stack([*ends, far - reach * across]).transpose(2, 0, 1)
        return np.asarray(shapely.intersection(whole, shapely.polygons(rings)))

    way, at, wanted = way[:, marked], at[marked], share[marked] * own.area[marked]
    low, high = -reach, reach.copy()
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        more = shapely.area(ahead(middle, way)) > wanted
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    at = np.where(np.isnan(wanted), at, (low + high) / 2)
    parts = np.stack([ahead(at, way), ahead(-at, -way)])
    least = LEAST_CELL * own.area[marked]
    good = np.all((shapely.area(parts) > least) & (shapely.get_type_id(parts) == 3), axis=0)
    cut, owner = parts[:, good].ravel(), np.tile(marked[good], 2)
    ring, piece = shapely.get_coordinates(shapely.get_exterior_ring(cut), return_index=True)
    inside = np.diff(piece, append=-1) == 0
    ring, piece = ring[inside].T, piece[inside]
    placed = own.centroid[:, owner[piece]]
    placed = placed + np.einsum("axk,ak->xk", axes[:, :, owner[piece]], ring)

    left = np.setdiff1d(np.arange(own.joint.size), marked[good])
    kept = np.flatnonzero(np.isin(own.cell, left))
    corners = np.concatenate([own.corners[:, kept], placed], axis=1)
    label = np.concatenate([np.searchsorted(left, own.cell[kept]), left.size + piece])
    joint = np.concatenate([own.joint[left], own.joint[owner]])
    order = np.argsort(joint, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(order.size)
    turned = np.argsort(rank[label], kind="stable")
    return Cells(corners[:, turned], rank[label][turned], joint[order])
