"""Random Voronoi assemblies on a floor, with densities over many decades."""

import numpy as np
import shapely
from scipy.spatial import Voronoi

import lacore as la


def cells(rng, count):
    """Voronoi cells of a 2 x 1 box: mirrored points make its walls edges of the cells."""
    points = rng.uniform(0.05, 0.95, (count, 2)) * [2, 1]
    images = [
        points,
        points * [-1, 1],
        points * [1, -1],
        [4, 0] + points * [-1, 1],
        [0, 2] + points * [1, -1],
    ]
    diagram = Voronoi(np.concatenate(images))
    rings = (diagram.vertices[diagram.regions[diagram.point_region[i]]] for i in range(count))
    return {
        f"b{i}": shapely.Polygon(np.round(ring, 12)).normalize().exterior.coords[:-1]
        for i, ring in enumerate(rings)
    }


def random_assembly(seed, decades):
    """Pushed by their weights, by their areas, or one of them by a force."""
    rng = np.random.default_rng(seed)
    count, mu = int(rng.integers(3, 16)), float(rng.uniform(0.1, 1.2))
    floor = [(-1, -0.5), (3, -0.5), (3, 0), (-1, 0)]
    blocks = la.BlockAssembly({"floor": floor, **cells(rng, count)}, friction=mu)
    densities = 10 ** rng.uniform(-decades / 2, decades / 2, count)
    weights = [(f"b{i}", float(rho)) for i, rho in enumerate(densities)]
    x, y = rng.uniform(-1, 1, 2)
    push, kind = (float(x), float(min(y, 0.3))), rng.integers(3)
    if kind == 0:
        loads = [la.BodyForce("b", (rho, 0.0), where=name) for name, rho in weights]
    elif kind == 1:
        loads = [la.BodyForce("b", push)]
    else:
        name, rho = weights[rng.integers(count)]
        loads = [la.BodyForce("b", (push[0] * rho, push[1] * rho), where=name)]
    return la.Problem(
        {"b": blocks},
        loads,
        [la.Fix("b", "floor")],
        dead_loads=[la.BodyForce("b", (0, -rho), where=name) for name, rho in weights],
    )
