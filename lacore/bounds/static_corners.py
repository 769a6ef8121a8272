"""Corners at which no linear stress can balance the loads (T25).

A velocity of the facets at one vertex can be free of strain in all elements there: across an
element with facets f and g, ``W_f = a L_g n_g`` and ``W_g = -a L_f n_f``. A corner that is filled
by one element has such a mode, a vertex with more only if the facets next to each inner one are in
line. Loads with power on it require two shear stresses at one place; then the load factor is fixed,
usually to 0, on every refinement that keeps the pattern.
"""

from collections.abc import Mapping

import numpy as np
from numpy.linalg import norm

from lacore.bounds.constants import CORNER_ROUND_OFF, PARALLEL
from lacore.bounds.equilibrium import EquilibriumDofs, element_geometry
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import InputError


class CornerError(InputError):
    """Loads that linear stresses cannot balance on this mesh, with the elements at fault."""

    def __init__(self, body: str, elements: list[int]) -> None:
        self.body, self.elements = body, elements
        super().__init__(
            f"Problem.bodies[{body!r}].mesh",
            elements,
            "the loads at a corner of these elements ask for two shear stresses in one place",
            "split them, `lacore.model.meshes.split(mesh, elements)`, or take a crossed mesh",
        )

    def __reduce__(self) -> tuple[type, tuple[object, ...]]:
        """Pickle by the arguments."""
        return CornerError, (self.body, self.elements)


def check_corners(
    full: KinematicProgram, basis: Sparse, bodies: Mapping[str, EquilibriumDofs]
) -> None:
    """Raise `CornerError` where loads do power on a mode without strain at a vertex.

    Args:
        full: the program for all multipliers.
        basis: of the free unknowns.
        bodies: by name.
    """
    loaded = np.abs(full.reference_load) + np.abs(full.dead_load)
    for name, dofs in bodies.items():
        sides, mesh = element_geometry(dofs.body)[1], dofs.body.mesh
        wrong: list[int] = []
        for vertex in _loaded_vertices(dofs, loaded):
            mode = _mode(dofs, sides, int(vertex), full.n)
            if mode is None or not _free(mode, basis) or _resisted(mode, full):
                continue
            power = max(abs(float(load @ mode)) for load in (full.reference_load, full.dead_load))
            if power > CORNER_ROUND_OFF * float(loaded @ np.abs(mode)):
                wrong += np.flatnonzero((mesh.t == vertex).any(axis=0)).tolist()
        if wrong:
            raise CornerError(name, sorted(set(wrong)))


def _loaded_vertices(dofs: EquilibriumDofs, loaded: Floats) -> Ints:
    """Return the ends of boundary facets with a load."""
    mesh = dofs.body.mesh
    facets = mesh.boundary_facets()
    ends = dofs.facet_nodes(facets)
    heavy = (loaded[2 * ends] + loaded[2 * ends + 1]) > 0
    return np.unique(mesh.facets[:, facets][heavy])


def _mode(dofs: EquilibriumDofs, sides: Floats, vertex: int, n: int) -> Floats | None:
    """Return the velocity of the facets at a vertex without strain, shape (n,), if there is one.

    Args:
        dofs: multipliers of the body.
        sides: length times outward normal of the facets of elements, shape (2, 3, elements).
        vertex: number of the vertex.
        n: number of unknowns.
    """
    mesh = dofs.body.mesh
    fan: dict[int, dict[int, Floats]] = {}  # sides of the two facets at the vertex, by element
    for e in np.flatnonzero((mesh.t == vertex).any(axis=0)):
        own = [j for j in range(3) if vertex in mesh.facets[:, mesh.t2f[j, e]]]
        fan[int(e)] = {int(mesh.t2f[j, e]): sides[:, j, e] for j in own}
    outer = [f for pair in fan.values() for f in pair if mesh.f2t[1, f] < 0]
    if len(outer) != 2:
        return None  # two corners that meet in one point
    facet = outer[0]
    velocity: dict[int, Floats] = {}
    while fan:
        pair = fan.pop(next(e for e, pair in fan.items() if facet in pair))
        (other,) = set(pair) - {facet}
        across = pair[other]
        w = velocity.setdefault(facet, across)
        if abs(w[0] * across[1] - w[1] * across[0]) > PARALLEL * norm(w) * norm(across):
            return None
        velocity[other] = -pair[facet] * (w @ across) / (across @ across)
        facet = other
    mode = np.zeros(n)
    for facet, w in velocity.items():
        start, end = dofs.facet_nodes(np.array([facet]))[:, 0]
        node = start if mesh.facets[0, facet] == vertex else end
        mode[2 * node : 2 * node + 2] = w
    return mode


def _free(mode: Floats, basis: Sparse) -> bool:
    """Return whether supports and footings allow it: the columns of the basis are orthogonal."""
    size = np.asarray(basis.multiply(basis).sum(axis=0)).ravel()
    left = basis @ ((basis.T @ mode) / size) - mode
    return bool(norm(left) <= CORNER_ROUND_OFF * norm(mode))


def _resisted(mode: Floats, full: KinematicProgram) -> bool:
    """Return whether contact resists it."""
    contact = full.contact
    rubs = (contact.limit > 0) | (contact.dilatancy > 0)
    moved = np.abs(contact.opening(mode)) + rubs * norm(contact.slip(mode), axis=1)
    return bool(moved.max(initial=0.0) > CORNER_ROUND_OFF * norm(mode))
