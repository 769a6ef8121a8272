"""Plastic flow of continua from nodal velocities, with independent interpolation and integration.

Elements are affine images of reference ones, so that velocities are polynomials of local
coordinates; their coefficients follow from the nodes, in any order.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import lacore as la
from lacore.model.bodies.continuum.slip import Slip
from lacore.numerics.arrays import Floats, Ints
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.continua.power import corners_of, edges_of, on_holders, strain_points
from lacore_verification.fuzz.continua.quadrature import in_cells, on_edges
from lacore_verification.fuzz.continua.soils import plastic_power, sides
from lacore_verification.fuzz.drawn.recipe import Soil, force_density

_POWERS = {
    "p1": ((0, 0), (1, 0), (0, 1)),
    "p2": ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)),
    "q2": tuple((i, j) for i in range(3) for j in range(3)),
}


@dataclass(frozen=True)
class Motion:
    """Velocity of a continuum, by element.

    Attributes:
        body: the body.
        slip: slip past supports and footings; None without.
        factors: of the monomials of local coordinates, (2, terms, cells).
        origin: (2, cells). inverse: from places to local coordinates, (2, 2, cells).
    """

    body: la.Body
    slip: Slip | None
    factors: Floats
    origin: Floats
    inverse: Floats

    @property
    def _powers(self) -> Ints:
        return np.array(_POWERS[self.body.space[:2]])

    def _local(self, cells: Any, places: Floats) -> Floats:
        """Return local coordinates of places (2, n, q), each in its cell."""
        away = places - self.origin[:, cells][:, :, None]
        return np.asarray(np.einsum("abn,bnq->anq", self.inverse[:, :, cells], away))

    def velocity(self, cells: Any, places: Floats) -> Floats:
        """Return velocities at places (2, n, q) of cells (n,)."""
        x, y = self._local(cells, places)
        terms = np.stack([x**i * y**j for i, j in self._powers])
        return np.asarray(np.einsum("ctn,tnq->cnq", self.factors[:, :, cells], terms))

    def strain_rate(self, places: Floats) -> Floats:
        """Return xx, yy, zz (hoop), 2 xy at places (2, cells, q) of all cells; (4, cells, q)."""
        every = np.arange(self.origin.shape[1])
        x, y = self._local(every, places)
        zero = np.zeros_like(x)
        by_local = np.stack(
            [
                np.stack([i * x ** (i - 1) * y**j if i else zero for i, j in self._powers]),
                np.stack([j * x**i * y ** (j - 1) if j else zero for i, j in self._powers]),
            ]
        )
        by_place = np.einsum("atnq,abn->btnq", by_local, self.inverse)
        rate = np.einsum("ctn,btnq->cbnq", self.factors, by_place)
        hoop = zero
        if self.body.axisymmetric:
            hoop = self.velocity(every, places)[0] / places[0]
        return np.stack([rate[0, 0], rate[1, 1], hoop, rate[0, 1] + rate[1, 0]])


def motion_of(state: la.LimitState, name: str) -> Motion:
    """Return the velocity of a body of a state."""
    dofs = state.discretisation.continua[name]
    mesh = dofs.body.mesh
    origin = mesh.p[:, mesh.t[0]]
    edges = mesh.p[:, mesh.t[[1, -1]]] - origin[:, None]
    inverse = np.linalg.inv(edges.transpose(2, 0, 1)).transpose(1, 2, 0)
    powers = _POWERS[dofs.body.space[:2]]
    nodes = dofs.element_nodes
    x, y = np.einsum("abn,bin->ain", inverse, dofs.nodes[:, nodes] - origin[:, None])
    terms = np.stack([x**i * y**j for i, j in powers], axis=1).transpose(2, 0, 1)
    values = state.velocity[name][:, nodes]
    factors = np.stack([np.linalg.solve(terms, v.T[:, :, None])[:, :, 0].T for v in values])
    return Motion(dofs.body, state.discretisation.slips.get(name), factors, origin, inverse)


def dissipation_inside(motion: Motion, data: Mapping[str, Any]) -> float:
    """Return plastic power within elements, without velocity jumps; `data` is that of the body."""
    places, weights = strain_points(motion.body)
    xx, yy, zz, xy = motion.strain_rate(places)
    if "soil" in data:
        within = sides(Soil(data), corners_of(motion.body), np.min)
        density = plastic_power(within, xx + yy, np.hypot(xx - yy, xy))
        return float(np.sum(weights * density))
    (region,) = motion.body.regions
    k = region.criterion.strength
    if motion.body.kinematics == "plane_strain":
        density = k * np.hypot(xx - yy, xy)
    elif motion.body.kinematics == "plane_stress":
        density = k * np.sqrt(np.maximum(4 * xx**2 + 4 * yy**2 + 4 * xx * yy + xy**2, 0.0))
    else:
        squares = xx**2 + yy**2 + zz**2 + xy**2 / 2 - (xx + yy + zz) ** 2 / 3
        density = k * np.sqrt(2 * np.maximum(squares, 0.0))
    return float(np.sum(weights * density))


def check_volume(motion: Motion, stress: Floats, name: str, power: float) -> Iterator[Wrong]:
    """Yield violations of constant volume in incompressible bodies.

    The volume change of a cell counts by its power with the actual stresses: in a body far from
    yield its strength is no measure of powers. In axisymmetric bodies triangles at a crossing keep
    their volume together (T27), so that their sum is checked.
    """
    if motion.body.kinematics == "plane_stress":
        return
    places, weights = strain_points(motion.body)
    growth = weights * motion.strain_rate(places)[:3].sum(axis=0)
    mean = stress[..., :3].mean(axis=-1)
    if motion.body.axisymmetric:
        lost = abs(np.sum(growth * mean)) + np.abs(stress).max() * abs(growth.sum())
    else:
        most = np.abs(mean).max(axis=1) + np.abs(stress).max(axis=(1, 2))
        lost = np.sum(np.abs(growth.sum(axis=1)) * most)
    yield from beyond("volume", f"of {name!r} grows with a power of", lost, power)


def load_power(motion: Motion, load: Mapping[str, Any]) -> float:
    """Return the power of a load on a body at factor one; for footings see `footing_power`."""
    body, kind = motion.body, load["load"]
    if kind == "BodyForce":
        places, weights = in_cells(body.mesh.p, body.mesh.t)
        v = motion.velocity(np.arange(weights.shape[0]), places)
        density = np.sum(force_density(load, places) * v, axis=0)
    else:
        start, end, outward = edges_of(body, load["where"])
        places, weights = on_edges(start, end)
        cells = body.mesh.f2t[0, np.asarray(body.mesh.boundaries[load["where"]])]
        v = motion.velocity(cells, places)
        if kind == "Pressure":
            density = -load["value"] * np.einsum("cn,cnq->nq", outward, v)
        else:
            force = np.array(load["vector"], dtype=float)[:, None] - on_holders(
                body, load, motion.slip
            )
            density = np.einsum("cn,cnq->nq", force, v)
    if body.axisymmetric:
        weights = weights * 2 * np.pi * places[0]
    return float(np.sum(weights * density))


def footing_power(motion: Motion, load: Mapping[str, Any], speed: float) -> float:
    """Return the power of a footing that moves at a speed; the body may slip along it (T23)."""
    start, end, _ = edges_of(motion.body, load["where"])
    length = np.linalg.norm(end - start, axis=0)
    if motion.body.axisymmetric:
        length = length * np.pi * (start[0] + end[0])
    return float(load.get("pressure", 1.0) * length.sum() * speed)


def power_on_footing(motion: Motion, load: Mapping[str, Any], carried: Mapping[str, Any]) -> float:
    """Return the power of a traction per unit speed of a footing along which the body slips."""
    if carried["load"] != "Traction" or carried["where"] != load["where"]:
        return 0.0
    start, end, _ = edges_of(motion.body, load["where"])
    direction = np.array(load["direction"]) / np.hypot(*load["direction"])
    along = direction @ on_holders(motion.body, carried, motion.slip)
    return float(along @ np.linalg.norm(end - start, axis=0))


def check_footing(
    motion: Motion, load: Mapping[str, Any], speed: float, largest: float
) -> Iterator[Wrong]:
    """Yield a failure if the face of a body leaves its footing, which does not rotate."""
    start, end, outward = edges_of(motion.body, load["where"])
    places, _ = on_edges(start, end)
    cells = motion.body.mesh.f2t[0, np.asarray(motion.body.mesh.boundaries[load["where"]])]
    across = np.einsum("cn,cnq->nq", outward, motion.velocity(cells, places))
    direction = np.array(load["direction"]) / np.hypot(*load["direction"])
    off = np.abs(across - speed * (direction @ outward)[:, None])
    yield from beyond("footing", "face leaves it at", off, largest)
