"""Thumbnails of problems that have no mechanism to show."""

from matplotlib.figure import Figure

from lacore.bodies.any_body import of_kind
from lacore.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.bodies.continuum.body import Body
from lacore.meshes.solid.faces import face_corners
from lacore.pictures.sketch.problem import draw_problem, extent_of
from lacore.pictures.sketch.sheet import Sheet
from lacore.pictures.space.acting import face_colours
from lacore.pictures.space.problem import block_colours
from lacore.pictures.space.structure import blocks_of
from lacore.pictures.thumbnails.paper import SIZE, Size, finish, paper, scale_of
from lacore.pictures.thumbnails.solids import blocks_on_paper, surfaces_on_paper
from lacore.problem.problem import Problem
from lacore.reporting.units import Units

_SYMBOLS = 0.3  # of the paper that symbols around the bodies take


def thumbnail_of_problem(problem: Problem, size: Size = SIZE) -> Figure:
    """Draw bodies, supports, contact and loads without a word.

    Args:
        problem: Any problem.
        size: Width and height, inches; the sketch fills it.
    """
    solids = of_kind(problem.bodies, BlockAssembly3D)
    if solids:
        blocks = blocks_of(solids.items())
        return blocks_on_paper(size, blocks, blocks.points, block_colours(problem, blocks))
    if problem.dimension == 3:
        meshes = {name: body.mesh for name, body in of_kind(problem.bodies, Body).items()}
        corners = {name: face_corners(own, own.boundary_facets()) for name, own in meshes.items()}
        return surfaces_on_paper(size, meshes, corners, face_colours(problem))
    axes = paper(size)
    point = 1 / ((1 - _SYMBOLS) * scale_of(size, extent_of(problem)))
    sheet = Sheet(axes, point, Units())
    draw_problem(sheet, problem)
    return finish(axes, *sheet.bounds())
