"""Virtual power of continua: random smooth velocity fields, their strain rates in closed form.

For every field of the velocity space the power of the stresses is that of loads, contacts and
supports. Fields are quadratic (linear where the space is), so each space contains them.

Where a body slips past a support or a footing, a traction along its side acts on the latter. The
forces of supports balance it, so that all of it counts here.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import lacore as la
from lacore.model.bodies.continuum.slip import Slip
from lacore.numerics.arrays import Floats, Ints
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.continua.quadrature import in_cells, on_edges
from lacore_verification.fuzz.drawn.recipe import Recipe, force_density
from lacore_verification.fuzz.drawn.touches import Touches

FIELDS = 4
_VERTICES = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
_ROOT = float(np.sqrt(0.6))
_GAUSS = (1 + _ROOT * np.array([-1.0, 0.0, 1.0])) / 2
_QUADS = np.stack([np.tile(_GAUSS, 3), np.repeat(_GAUSS, 3)])
_QUAD_SHARE = np.outer([5.0, 8.0, 5.0], [5.0, 8.0, 5.0]).ravel() / 324
_POINTS: Mapping[str, tuple[Floats, Floats]] = {
    "p2-vertex": (_VERTICES, np.full(3, 1 / 3)),
    "p2-disc": (_VERTICES, np.full(3, 1 / 3)),
    "p2-gauss": ((1 + 3 * _VERTICES) / 6, np.full(3, 1 / 3)),
    "p1": (np.full((2, 1), 1 / 3), np.ones(1)),
    "p1-disc": (np.full((2, 1), 1 / 3), np.ones(1)),
    "q2": (_QUADS, _QUAD_SHARE),
}
"""Stress points of each space on the reference element, and their weights."""


@dataclass(frozen=True)
class Field:
    """A velocity ``v = a + B d + quadratic``, d = (x - centre) / length.

    In axisymmetric bodies ``v_r`` is r times that, and linear: zero on the axis, with smooth hoop
    rates.

    Attributes:
        factors: of 1, dx, dy, dx^2, dx dy, dy^2 in both components, (2, 6).
    """

    factors: Floats
    centre: Floats
    length: float
    round_: bool

    def _terms(self, places: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the terms and their derivatives with respect to x and y, (6, ...)."""
        one, zero = np.ones(places.shape[1:]), np.zeros(places.shape[1:])
        x = (places[0] - self.centre[0]) / self.length
        y = (places[1] - self.centre[1]) / self.length
        along_x = np.stack([zero, one, zero, 2 * x, y, zero]) / self.length
        along_y = np.stack([zero, zero, one, zero, x, 2 * y]) / self.length
        return np.stack([one, x, y, x * x, x * y, y * y]), along_x, along_y

    def velocity(self, places: Floats) -> Floats:
        """Return velocities at places (2, ...)."""
        result = np.tensordot(self.factors, self._terms(places)[0], 1)
        if self.round_:
            result[0] *= places[0] / self.length
        return np.asarray(result)

    def strain_rate(self, places: Floats) -> Floats:
        """Return xx, yy, zz (hoop), 2 xy; (4, ...)."""
        terms, along_x, along_y = self._terms(places)
        value = np.tensordot(self.factors, terms, 1)
        by_x, by_y = np.tensordot(self.factors, along_x, 1), np.tensordot(self.factors, along_y, 1)
        hoop = np.zeros(places.shape[1:])
        if self.round_:
            r = places[0] / self.length
            hoop = value[0] / self.length
            by_x[0] = by_x[0] * r + value[0] / self.length
            by_y[0] = by_y[0] * r
        return np.stack([by_x[0], by_y[1], hoop, by_y[0] + by_x[1]])


def random_field(rng: np.random.Generator, body: la.Body) -> Field:
    """Return a field of order one in the space of a body."""
    factors = rng.uniform(-1, 1, (2, 6))
    if body.space.startswith("p1"):
        factors[:, 3:] = 0.0
    if body.axisymmetric:
        factors[0, 3:] = 0.0
    points = body.mesh.p
    return Field(factors, points.mean(axis=1), float(np.ptp(points)), body.axisymmetric)


def rigid_field(rng: np.random.Generator, body: la.Body) -> Field:
    """Return a field without strain, for the balance of the body as a whole."""
    factors = np.zeros((2, 6))
    factors[:, 0] = rng.uniform(-1, 1, 2)
    factors[0, 2] = rng.uniform(-1, 1)
    factors[1, 1] = -factors[0, 2]
    if body.axisymmetric:
        factors[0], factors[1, 1] = 0.0, 0.0
    points = body.mesh.p
    return Field(factors, points.mean(axis=1), float(np.ptp(points)), body.axisymmetric)


def check_power(
    recipe: Recipe,
    problem: la.Problem,
    points: Touches,
    state: la.LimitState,
    rng: np.random.Generator,
) -> Iterator[Wrong]:
    """Yield violations of the balance of each continuum, as a whole and inside."""
    supports, stresses = state.support_reactions, state.stress
    for name, body in problem.bodies.items():
        if not isinstance(body, la.Body):
            continue
        own = supports[supports["body"] == name]
        for number in range(FIELDS):
            whole = number == 0
            field = rigid_field(rng, body) if whole else random_field(rng, body)
            inner, stressed = _inside(body, field, stresses[name])
            loads = [
                (factor * power, abs(factor) * most)
                for factor, key in ((state.load_factor, "reference"), (1.0, "dead"))
                for load in recipe[key]
                if load["body"] == name
                for power, most in [_load_power(body, field, load)]
            ]
            at = np.stack([own["x"].to_numpy(), own["y"].to_numpy()])
            v = field.velocity(at)
            held = v[0] * own["force_x"].to_numpy() + v[1] * own["force_y"].to_numpy()
            touch = _touch(points, name, field)
            total = inner.sum() - sum(power for power, _ in loads) - held.sum() - touch.sum()
            size = (
                stressed
                + np.abs(loads).sum()
                + np.hypot(*v) @ np.hypot(own["force_x"].to_numpy(), own["force_y"].to_numpy())
            )
            size += np.abs(points.of((name, ""))) @ (
                np.hypot(*points.force.T) * np.hypot(*field.velocity(points.place.T))
            )
            check = "balance of a continuum" if whole else "virtual power"
            yield from beyond(check, f"of {name!r} off by", abs(total), size)


def _inside(body: la.Body, field: Field, stress: Floats) -> tuple[Floats, float]:
    """Return the power of the stresses by strain point, and the sum of its magnitudes."""
    places, weights = strain_points(body)
    rate = field.strain_rate(places)
    density = np.einsum("eqc,ceq->eq", stress, rate)
    most = np.linalg.norm(stress, axis=2) * np.linalg.norm(rate, axis=0)
    return np.asarray(weights * density), float(np.sum(weights * most))


def strain_points(body: la.Body) -> tuple[Floats, Floats]:
    """Return stress points, (2, cells, q), and their weights, (cells, q)."""
    reference, share = _POINTS[body.space]
    points, cells = body.mesh.p, body.mesh.t
    corner = [points[:, cells[i]] for i in range(len(cells))]
    x, y = reference
    if len(cells) == 3:
        shapes = np.stack([1 - x - y, x, y])
        (ax, ay), (bx, by) = corner[1] - corner[0], corner[2] - corner[0]
        area = (np.abs(ax * by - ay * bx) / 2)[:, None]
        weights = area * share
    else:
        shapes = np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
        by_x = np.stack([-(1 - y), 1 - y, y, -y])
        by_y = np.stack([-(1 - x), -x, x, 1 - x])
        (xa, ya) = sum(c[:, :, None] * s for c, s in zip(corner, by_x, strict=True))
        (xb, yb) = sum(c[:, :, None] * s for c, s in zip(corner, by_y, strict=True))
        weights = np.abs(xa * yb - ya * xb) * share
    places = sum(c[:, :, None] * s for c, s in zip(corner, shapes, strict=True))
    if body.axisymmetric:
        weights = weights * 2 * np.pi * places[0]
    return np.asarray(places), np.asarray(weights)


def corners_of(body: la.Body) -> Floats:
    """Corners of all cells, shape (2, cells, 3 or 4)."""
    return np.asarray(body.mesh.p[:, body.mesh.t].transpose(0, 2, 1))


def _touch(points: Touches, body: str, field: Field) -> Floats:
    """Return the power of the contact forces on a body, by point."""
    sign = points.of((body, ""))
    v = points.control_values(field.velocity)
    return np.asarray(sign * np.sum(points.force * v, axis=1))


def _load_power(body: la.Body, field: Field, load: Mapping[str, Any]) -> tuple[float, float]:
    """Return the power of a load on a body at factor one, and the sum of its magnitudes.

    The load of a footing is in the table of support forces.
    """
    kind = load["load"]
    if kind == "RigidFooting":
        return 0.0, 0.0
    if kind == "PointForce":
        v = field.velocity(np.reshape(np.array(load["at"], dtype=float), (2, 1)))[:, 0]
        return float(np.array(load["vector"]) @ v), float(np.hypot(*load["vector"]) * np.hypot(*v))
    if kind == "BodyForce":
        places, weights = in_cells(body.mesh.p, body.mesh.t)
        force = force_density(load, places)
    else:
        start, end, outward = edges_of(body, load["where"])
        places, weights = on_edges(start, end)
        force = np.repeat(
            np.array(load.get("vector", (0, 0)), dtype=float)[:, None], start.shape[1], 1
        )
        if kind == "Pressure":
            force = -load["value"] * outward
        force = np.repeat(force[:, :, None], places.shape[2], 2)
    if body.axisymmetric:
        weights = weights * 2 * np.pi * places[0]
    v = field.velocity(places)
    most = np.hypot(*force) * np.hypot(*v)
    return float(np.sum(weights * np.sum(force * v, axis=0))), float(np.sum(weights * most))


def on_holders(body: la.Body, load: Mapping[str, Any], slip: Slip | None) -> Floats:
    """Return the part of a traction that acts on supports of the body, Pa, (2, n) on its edges."""
    _, _, outward = edges_of(body, load["where"])
    tangent = np.stack([-outward[1], outward[0]])
    along = tangent * (np.array(load["vector"], dtype=float) @ tangent)
    slips = np.isin(body.mesh.boundaries[load["where"]], [] if slip is None else slip.facets)
    return np.where(slips, along, 0.0)


def load_size(body: la.Body, load: Mapping[str, Any]) -> float:
    """Return the sum of the magnitudes of a load at factor one, N/m (N)."""
    if load["load"] == "PointForce":
        return float(np.hypot(*load["vector"]))
    if load["load"] == "BodyForce":
        places, weights = in_cells(body.mesh.p, body.mesh.t)
    else:
        start, end, _ = edges_of(body, load["where"])
        places, weights = on_edges(start, end)
    if body.axisymmetric:
        weights = weights * 2 * np.pi * places[0]
    if load["load"] == "BodyForce":
        return float(np.sum(weights * np.hypot(*force_density(load, places))))
    density = {"Pressure": "value", "RigidFooting": "pressure"}.get(load["load"])
    size = np.hypot(*load["vector"]) if density is None else abs(load.get(density, 1.0))
    return float(size * weights.sum())


def edges_of(body: la.Body, name: str) -> tuple[Floats, Floats, Floats]:
    """Return the ends (2, n) of the edges of a boundary, and outward normals."""
    mesh = body.mesh
    facets: Ints = np.asarray(mesh.boundaries[name])
    start, end = (mesh.p[:, mesh.facets[i, facets]] for i in (0, 1))
    along = (end - start) / np.linalg.norm(end - start, axis=0)
    normal = np.stack([along[1], -along[0]])
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    sign = np.sign(np.sum(normal * (start - inside), axis=0))
    return start, end, normal * sign
