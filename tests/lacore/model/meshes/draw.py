"""Draws the meshes beside it, with gmsh: ``python tests/lacore/model/meshes/draw.py``."""

from contextlib import contextmanager
from pathlib import Path

import gmsh

HERE = Path(__file__).parent


@contextmanager
def session():
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield gmsh.model
    finally:
        gmsh.finalize()


def polygon(model, corners, loops):
    """Corners (x, y, size); surfaces by name as loops of corner numbers. Sides shared are one."""
    points = [model.geo.addPoint(x, y, 0, size) for x, y, size in corners]
    sides, surfaces = {}, {}

    def side(start, end):
        if (end, start) in sides:
            return -sides[end, start]
        if (start, end) not in sides:
            sides[start, end] = model.geo.addLine(points[start], points[end])
        return sides[start, end]

    for name, loop in loops.items():
        curve = [side(*ends) for ends in zip(loop, loop[1:] + loop[:1], strict=True)]
        surfaces[name] = model.geo.addPlaneSurface([model.geo.addCurveLoop(curve)])
    model.geo.synchronize()
    for name, surface in surfaces.items():
        model.addPhysicalGroup(2, [surface], name=name)
    return sides


def punch(model):
    """Half of the Prandtl punch, finest under the edge of the footing."""
    corners = [(0, -2, 0.8), (4, -2, 1.0), (4, 0, 0.8), (1, 0, 0.08), (0, 0, 0.4)]
    sides = polygon(model, corners, {"soil": [0, 1, 2, 3, 4]})
    for ends, name in zip(sides, ("bottom", "right", "free", "footing", "left"), strict=True):
        model.addPhysicalGroup(1, [sides[ends]], name=name)
    model.mesh.generate(2)


def layers(model):
    """A block on a wider layer; the joint is a side of both."""
    corners = [(0, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1), (2, 2), (1, 2)]
    loops = {"layer": [0, 1, 2, 3, 4, 5], "upper block": [4, 3, 6, 7]}
    sides = polygon(model, [(*corner, 0.6) for corner in corners], loops)
    for ends, name in {(0, 1): "base", (3, 4): "joint", (6, 7): "top"}.items():
        model.addPhysicalGroup(1, [sides[ends]], name=name)
    model.addPhysicalGroup(1, [sides[0, 1], sides[1, 2], sides[5, 0]])  # nameless, overlapping
    model.mesh.generate(2)


def footing(model):
    """An eighth of the ground under a square footing, of two regions, finer under its edge."""
    corners = [(0, 0, 0.7), (1, 0, 0.5), (2, 0, 1.2), (2, 2, 1.2), (1, 1, 0.5)]
    polygon(model, corners, {"under": [0, 1, 4], "beside": [1, 2, 3, 4]})
    model.removePhysicalGroups()
    model.geo.extrude([(2, 1), (2, 2)], 0, 0, -1)
    model.geo.synchronize()
    sides = {
        "footing": ((0, 0, 0), (1, 1, 0)),
        "front": ((0, 0, -1), (2, 0, 0)),
        "right": ((2, 0, -1), (2, 2, 0)),
        "bottom": ((0, 0, -1), (2, 2, -1)),
    }
    for name, (low, high) in sides.items():
        box = (*(own - 1e-6 for own in low), *(own + 1e-6 for own in high))
        own = model.getEntitiesInBoundingBox(*box, 2)
        model.addPhysicalGroup(2, [tag for _, tag in own], name=name)
    for number, name in enumerate(("under", "beside"), start=1):
        model.addPhysicalGroup(3, [number], name=name)
    model.mesh.generate(3)


if __name__ == "__main__":
    for draw in (punch, layers, footing):
        with session() as model:
            draw(model)
            gmsh.write(str(HERE / f"{draw.__name__}.msh"))
