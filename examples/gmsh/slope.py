"""How high can a slope of clay stand? A mesh of gmsh, its physical groups as names, both bounds.

A slope of 45 degrees and height 1 over firm ground at depth 1 below its toe. The load factor is the
stability number gamma H / c; the best slip circle, an upper bound itself, gives 5.53.

    pip install 'lacore-limit-analysis[gmsh]'
    python examples/gmsh/slope.py
"""

import sys
from pathlib import Path

import gmsh

import lacore as la

OUTLINE = {  # each corner, and the name of the side from it to the next one
    (-2.5, -1.0): "base",
    (4.0, -1.0): "right",
    (4.0, 1.0): "crest",
    (1.0, 1.0): "slope",
    (0.0, 0.0): "toe",
    (-2.5, 0.0): "left",
}


def draw(path: Path, size: float) -> None:
    """Write the mesh: triangles of a length `size`, a fifth of that at the toe of the slope."""
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        geometry = gmsh.model.geo
        corners = [
            geometry.addPoint(x, y, 0, size / 5 if (x, y) == (0, 0) else size) for x, y in OUTLINE
        ]
        sides = [
            geometry.addLine(corner, following)
            for corner, following in zip(corners, corners[1:] + corners[:1], strict=True)
        ]
        surface = geometry.addPlaneSurface([geometry.addCurveLoop(sides)])
        geometry.synchronize()
        for side, name in zip(sides, OUTLINE.values(), strict=True):
            gmsh.model.addPhysicalGroup(1, [side], name=name)
        gmsh.model.addPhysicalGroup(2, [surface], name="clay")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def state(path: Path) -> la.Problem:
    """The problem on the mesh of a file."""
    clay = la.Body(la.meshes.read(path, surface="clay"), la.VonMises(shear_strength=1.0))
    return la.Problem(
        bodies={"clay": clay},
        supports=[
            la.Fix("clay", "base"),
            la.Fix("clay", "left", components="x"),
            la.Fix("clay", "right", components="x"),
        ],
        reference_loads=[la.BodyForce("clay", (0, -1))],  # alpha times a unit weight of 1
    )


def main(path: Path, size: float) -> tuple[float, float]:
    """Lower and upper bound of the stability number, on a mesh that is drawn afresh."""
    draw(path, size)
    problem = state(path)
    return la.lower_bound(problem).load_factor, la.solve(problem).load_factor


if __name__ == "__main__":
    file = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).with_name("slope.msh"))
    sys.stdout.write("{:.4f} <= gamma H / c <= {:.4f}\n".format(*main(file, size=0.6)))
