"""Builders of three-dimensional blocks: domes, arches, vaults, walls, corners, stairs, files."""

from lacore.model.bodies.blocks3d.builders.domes import dome
from lacore.model.bodies.blocks3d.builders.prisms import extruded
from lacore.model.bodies.blocks3d.builders.reading import read
from lacore.model.bodies.blocks3d.builders.vaults import arch, barrel_vault, cross_vault
from lacore.model.bodies.blocks3d.builders.walls import corner, stairs, wall

__all__ = [
    "arch",
    "barrel_vault",
    "corner",
    "cross_vault",
    "dome",
    "extruded",
    "read",
    "stairs",
    "wall",
]
