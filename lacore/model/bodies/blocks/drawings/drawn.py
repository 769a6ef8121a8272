"""Drawn blocks with their layers and densities, and a report on the drawing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.materials.friction import Friction, friction_law
from lacore.reporting.errors import (
    InputError,
    is_number,
    is_plane_vector,
    require_known,
    require_range,
)
from lacore.reporting.showing import Compact, Facts, Shown, counted, listed
from lacore.reporting.text import Term, text

GRAVITY = 9.80665  # m/s^2, standard (CGPM 1901)


@dataclass(frozen=True, repr=False)
class Layer(Compact):
    """Material of the blocks of a layer.

    Attributes:
        friction: law of joints between them: a Coulomb coefficient, `Coulomb`, `Tresca`, ...
        density: kg/m^3; 0 for blocks that are held.

    Example:
        >>> stone = la.masonry.Layer(friction=0.6, density=2000.0)  # kg/m^3
    """

    friction: float | Friction
    density: float

    def __post_init__(self) -> None:
        friction_law(self.friction, "Layer.friction")
        if not is_number(self.density) or self.density < 0:
            raise InputError("Layer.density", self.density, "not a density", "give kg/m^3, or 0")
        require_range("Layer.density", self.density)


@dataclass(frozen=True, eq=False, repr=False)
class DrawnBlocks(Shown):
    """Blocks of a drawing, named after their layers: "stone 1", "stone 2", ... from below.

    Attributes:
        blocks: the body.
        layers: the given layers.
        layer: layer of each block, by name.
        handles: handles of the drawn entities of each block, by name.
        path: path of the file.
        unit: unit of the drawing, from the file or the user.
        snap: m: vertices closer than this are merged.
        moved: the farthest that a vertex was moved, m.
        gap: m: width of joints by which the outlines were moved towards each other, if any.
        repeated: handles of blocks that are drawn several times, and are read once.
        skipped: numbers of entities in the layers that are not lines, by kind.
        ignored: other layers.
    """

    blocks: BlockAssembly
    layers: Mapping[str, Layer]
    layer: Mapping[str, str]
    handles: Mapping[str, str]
    path: str
    unit: str
    snap: float
    moved: float
    skipped: Mapping[str, int]
    ignored: tuple[str, ...]
    gap: float | None = None
    repeated: tuple[str, ...] = ()

    def named(self, layer: str) -> tuple[str, ...]:
        """Return the names of the blocks of a layer.

        Raises `InputError` for one that was not read.
        """
        require_known("layer", layer, self.layers)
        return tuple(name for name, own in self.layer.items() if own == layer)

    def at(self, place: Sequence[float]) -> str:
        """Return the name of the block at a place (x, y), m.

        Raises `InputError` if there is none.
        """
        if not is_plane_vector(place):
            raise InputError("place", place, "not a place", "give (x, y) in m")
        polygons = [shapely.Polygon(ring) for ring in self.blocks.polygons.values()]
        away = shapely.distance(polygons, shapely.Point(place))
        nearest = self.blocks.names[int(np.argmin(away))]
        if away.min() > self.blocks.allowed:
            raise InputError("place", tuple(place), "no block is there", f"nearest is {nearest!r}")
        return nearest

    def weight(self, body: str, direction: tuple[float, float] = (0.0, -1.0)) -> list[BodyForce]:
        """Return loads of density times standard gravity, one per layer.

        Args:
            body: name of the blocks in the problem.
            direction: of unit length for weight; ``(1, 0)`` is an acceleration of 1 g against x.

        Raises:
            InputError: an invalid direction, or densities that are all 0.
        """
        if not is_plane_vector(direction) or not np.any(direction):
            raise InputError("direction", direction, "not a direction", "give (x, y), not (0, 0)")
        heavy = {name: own for name, own in self.layers.items() if own.density > 0}
        if not heavy:
            fix = text(
                "give {}",
                Term("Layer(density=)", "density, as in { friction = 0.6, density = 2400 }"),
            )
            raise InputError("layers", None, "no layer has a density", fix)
        x, y = direction
        return [
            BodyForce(
                body, (x * own.density * GRAVITY, y * own.density * GRAVITY), self.named(name)
            )
            for name, own in heavy.items()
        ]

    @property
    def gaps(self) -> str:
        """Text on blocks without a joint, and their distances; empty if all have one."""
        loose = [self.blocks.names.index(name) for name in self._loose()]
        if not loose or len(self.blocks.names) < 2:
            return ""
        polygons = np.array([shapely.Polygon(ring) for ring in self.blocks.polygons.values()])
        _, away = shapely.STRtree(polygons).query_nearest(
            polygons[loose], exclusive=True, return_distance=True, all_matches=False
        )
        near, far = f"{away.min():.3g}", f"{away.max():.3g}"
        return f"{counted(len(loose), 'block')} {near} to {far} m from the next: give gap={near}?"

    def _loose(self) -> list[str]:
        """Return the names of the blocks without a joint."""
        joints = self.blocks.joints
        met = {*joints.master.tolist(), *joints.slave.tolist()}
        return [name for number, name in enumerate(self.blocks.names) if number not in met]

    def facts(self) -> Facts:
        """Return the blocks, the unit, and how far vertices were moved, for printing."""
        counts = [f"{len(self.named(name))} in {name!r}" for name in self.layers]
        left = f"; {listed(self.ignored)} ignored" if self.ignored else ""
        told = {
            "drawing": f"{Path(self.path).name}, in {self.unit}",
            "layers": ", ".join(counts) + left,
            "snap": f"{self.snap:.3g} m; vertices moved by {self.moved:.2g} m at most",
        }
        if self.gap is not None:
            told["gap"] = f"{self.gap:.3g} m between blocks closed"
        if self.repeated:
            times = counted(len(self.repeated), "block")
            told["repeated"] = f"{times} drawn several times and read once: {listed(self.repeated)}"
        if gaps := self.gaps:
            told["gaps"] = gaps
        if self.skipped:
            told["no lines"] = ", ".join(counted(n, kind) for kind, n in self.skipped.items())
        return Facts(f"DrawnBlocks: {self.blocks.contents}", told)
