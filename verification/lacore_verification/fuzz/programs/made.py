"""Problems of a given number of unknowns: walls, blocks in 3D, frames, tetrahedra."""

import numpy as np

import lacore as la
from lacore_verification.fuzz.drawn.draw import Rng, chosen, number, vector

_LARGEST = 500  # Nodes of a frame: compatible motions are quadratic in it.


def wall(rng: Rng, size: int) -> la.Problem:
    """Return a wall in bond, with some blocks omitted, under horizontal acceleration or a push."""
    blocks = max(size // 3, 2)
    high = int(np.clip(round(np.sqrt(blocks * number(rng, 0.3, 2.0))), 1, 40))
    wide = max(blocks // high, 1)
    rows = []
    for course in range(high):
        row = [1.0] * wide if course % 2 == 0 else [0.5, *[1.0] * (wide - 1), 0.5]
        for place in range(1, len(row) - 1):
            if 0 < course < high - 1 and rng.random() < 0.02 and row[place - 1] > 0:
                row[place] = -row[place]
        rows.append(row)
    assembly = la.masonry.running_bond(rows, number(rng, 0.2, 1.0))
    own = tuple(name for name in assembly.names if name != "base")
    where = own if rng.random() < 0.6 else (str(chosen(rng, own)),)
    return la.Problem(
        bodies={"wall": assembly},
        supports=[la.Fix("wall", "base")],
        reference_loads=[la.BodyForce("wall", tuple(vector(rng)), where)],
        dead_loads=[la.BodyForce("wall", (0, -1), own)],
    )


def assembly_in_space(rng: Rng, size: int) -> la.Problem:
    """Return a wall of boxes in 3D, of several wythes, under acceleration in any direction."""
    blocks = max(size // 6, 2)
    high = int(np.clip(round(blocks ** (1 / 3) * number(rng, 0.6, 1.6)), 1, 12))
    deep = int(rng.integers(1, 3))
    wide = max(blocks // (high * deep), 1)
    polyhedra = {"base": _box((-1.0, -1.0, -1.0), (wide + 1.0, deep + 1.0, 0.0))}
    for k in range(high):
        lead = 0.5 * (k % 2)
        for j in range(deep):
            for i in range(wide):
                low = (i + lead, float(j), 0.5 * k)
                polyhedra[f"b{k}-{j}-{i}"] = _box(low, (low[0] + 1, low[1] + 1, low[2] + 0.5))
    assembly = la.BlockAssembly3D(polyhedra, number(rng, 0.2, 1.0))
    own = tuple(name for name in assembly.names if name != "base")
    push = rng.normal(size=3)
    return la.Problem(
        bodies={"wall": assembly},
        supports=[la.Fix("wall", ("base",), "xyz")],
        reference_loads=[la.BodyForce("wall", tuple(push / np.linalg.norm(push)), own)],
        dead_loads=[la.BodyForce("wall", (0.0, 0.0, -1.0), own)],
    )


def grid_frame(rng: Rng, size: int) -> la.Problem:
    """Return a frame of bays and storeys under forces at nodes, with some members missing."""
    nodes = max(min(size, _LARGEST), 6)
    storeys = int(np.clip(round(np.sqrt(nodes * number(rng, 0.5, 3.0))), 1, 60))
    bays = max(nodes // (storeys + 1) - 1, 1)
    places = {f"n{i}-{j}": (3.0 * i, 2.5 * j) for i in range(bays + 1) for j in range(storeys + 1)}
    members = {
        f"c{i}-{j}": (f"n{i}-{j}", f"n{i}-{j + 1}") for i in range(bays + 1) for j in range(storeys)
    }
    members |= {
        f"b{i}-{j}": (f"n{i}-{j}", f"n{i + 1}-{j}")
        for i in range(bays)
        for j in range(1, storeys + 1)
        if j == storeys or rng.random() > 0.03
    }
    strengths = {name: number(rng, 0.5, 3.0) for name in members}
    frame = la.Frame(places, members, strengths)
    feet = [f"n{i}-0" for i in range(bays + 1)]
    upper = [name for name in places if name not in feet]
    pushed = rng.choice(upper, size=min(len(upper), 1 + len(upper) // 10), replace=False)
    return la.Problem(
        bodies={"frame": frame},
        supports=[la.Fix("frame", foot, chosen(rng, ("clamped", "xy"))) for foot in feet],
        reference_loads=[la.PointForce("frame", str(name), tuple(vector(rng))) for name in pushed],
        dead_loads=[
            la.PointForce("frame", name, (0.0, -0.01))
            for name in (upper if rng.random() < 0.3 else ())
        ],
    )


def solid(rng: Rng, size: int) -> la.Problem:
    """A box of tetrahedra under a footing or a traction."""
    space = chosen(rng, ("p2-vertex", "p1-disc"))
    per_cell = {"p2-vertex": 24, "p1-disc": 72}[space]
    cells = max((size / per_cell) ** (1 / 3), 1.0)
    nx, ny, nz = (max(round(cells * number(rng, 0.7, 1.4)), 1) for _ in range(3))
    mesh = la.meshes.box((0, 1), (0, number(rng, 0.5, 1.5)), (0, 1), nx, ny, nz)
    law = la.VonMises(shear_strength=number(rng, 0.5, 2.0))
    earth = chosen(rng, (law, law, la.DruckerPrager(1.0, number(rng, 5, 20), "compression")))
    load = chosen(
        rng,
        (
            la.Traction("block", "top", tuple(rng.normal(size=3))),
            la.RigidFooting("block", "top", (0, 0, -1), rough=bool(rng.random() < 0.5)),
        ),
    )
    return la.Problem(
        bodies={"block": la.Body(mesh, earth, kinematics="3d", space=space)},
        supports=[la.Fix("block", "bottom", "xyz")],
        reference_loads=[load],
        dead_loads=[la.BodyForce("block", (0, 0, -number(rng, 0.05, 0.3)))]
        if rng.random() < 0.5
        else [],
    )


def _box(low: tuple[float, ...], high: tuple[float, ...]) -> la.Polyhedron:
    (a, b, c), (d, e, f) = low, high
    ground = ((a, b), (d, b), (d, e), (a, e))
    corners = np.array([(x, y, z) for z in (c, f) for x, y in ground])
    sides = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    return la.Polyhedron(corners, sides)
