"""Dissipation of elements on a lattice: above its integral, and close to it (T22).

The vertex rule of each triangle of the lattice is above the integral of the convex dissipation. If
strengths are linear in the element, the strength in the triangle at vertex i is ``(k_i + k_1 + k_2
+ k_3)/4``: the integral of k times an interpolant that is above the dissipation per k at each place
(T85).
"""

from functools import cache

import numpy as np

from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.regions.varying import Varying, vertex_rule
from lacore.model.bodies.continuum.solid.lattice import divided
from lacore.model.bodies.continuum.spaces import VelocitySpace
from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup
from lacore.program.surfaces import Surfaces


def on_lattice(
    region: Region, group: DissipationGroup, velocity: Floats, space: VelocitySpace, parts: int
) -> Floats:
    """Return the plastic power of elements of a region, at least that of the continuum, (e,).

    Args:
        region: region with strengths known everywhere.
        group: its dissipation at the strain points.
        velocity: velocity of all unknowns.
        space: velocity space with strain rates linear in an element.
        parts: number of parts of each edge.
    """
    count = space.points.shape[1]
    places, share = lattice(parts, len(space.points) + 1)
    onto = places @ space.to_vertices()
    area = group.weights.reshape(-1, count).sum(axis=1)
    if group.surfaces is not None:
        return np.asarray(area * (_pressed(region, group, velocity, onto, parts) @ share))
    strained = (group.rates(velocity) > 0)[:, None]
    known = np.where(strained, group.cone_vectors(velocity), 0.0).reshape(-1, count, group.dim)
    size = np.linalg.norm(np.einsum("pq,eqd->epd", onto, known), axis=2)
    if region.form.varies:
        bound, _ = _strengths(region, parts)
        return np.asarray(area * ((bound.reshape(size.shape) * size) @ share))
    strength = (group.weights * group.bound).reshape(-1, count).sum(axis=1)
    return np.asarray(strength * (size @ share))


def _pressed(
    region: Region,
    group: DissipationGroup,
    velocity: Floats,
    onto: Floats,
    parts: int,
) -> Floats:
    """Return the power per volume for pressure-dependent strength, at the places, (e, p).

    It is convex as well.
    """
    assert group.surfaces is not None
    count, places = onto.shape[1], len(onto)
    known = group.cone_vectors(velocity).reshape(-1, count, group.dim)
    length = np.linalg.norm(np.einsum("pq,eqd->epd", onto, known), axis=2)
    volume = (group.volumetric @ velocity).reshape(-1, count) @ onto.T
    if region.form.varies:
        _, surfaces = _strengths(region, parts)
        assert surfaces is not None
    else:
        surfaces = group.surfaces.at(np.repeat(count * np.arange(len(known)), places))
    power = surfaces.dissipation(length.ravel(), volume.ravel())
    return np.asarray(power.reshape(-1, places))


def _strengths(region: Region, parts: int) -> tuple[Floats, Surfaces | None]:
    """Return bounds and surfaces at the lattice places of each element of a region."""

    def values(varies: Varying) -> Floats:
        return np.asarray(varies.above() @ _shares(parts, varies.vertex.shape[1]).T)

    corners = next(own.vertex.shape[1] for _, own in region.varying)
    return region.at_points(values, len(_shares(parts, corners)))


@cache
def _shares(parts: int, corners: int) -> Floats:
    """Return the weights of the strengths at vertices for each place, (p, corners)."""
    if corners == 4:
        return _shares_in_space(parts)
    places, weights = lattice(parts)
    whole = np.rint(places * parts).astype(np.int64)
    number = {tuple(place): at for at, place in enumerate(whole.tolist())}
    total = np.zeros((len(whole), 3))
    for turn in (1, -1):  # triangles with the orientation of the element, and the others
        for i, j in np.ndindex(parts + 2, parts + 2):
            k = parts - turn - i - j
            around = [(i + turn, j, k), (i, j + turn, k), (i, j, k + turn)]
            known = [number[corner] for corner in around if corner in number]
            if len(known) == 3:
                total[known] += vertex_rule(3) @ places[known] / (3 * parts**2)
    return np.asarray(total / weights[:, None])


def _shares_in_space(parts: int) -> Floats:
    (places, weights), (_, simplices) = lattice(parts, 4), divided(parts, 4)
    total = np.zeros((len(places), 4))
    np.add.at(total, simplices, vertex_rule(4) @ places[simplices] / (4 * parts**3))
    return np.asarray(total / weights[:, None])


def lattice(parts: int, corners: int = 3) -> tuple[Floats, Floats]:
    """Return barycentric coordinates, (p, corners), and weights of sum 1, by adjacent parts."""
    if corners == 4:
        places, simplices = divided(parts, 4)
        return places, np.bincount(simplices.ravel()) / (4 * parts**3)
    whole = np.array(
        [(i, j, parts - i - j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    )
    triangles = np.array([6, 3, 1])[(whole == 0).sum(axis=1)]
    return whole / parts, triangles / (3 * parts**2)
