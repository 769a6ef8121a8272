"""Mirror symmetries of a structure, proven for its assembled program (T82)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial import KDTree

from lacore.analyses.parameters import size_of
from lacore.assembly.discretisation import Discretisation
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.conditions.loads import Load
from lacore.model.materials.fields import varying
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import ContactRows

_SAME = 1e-9  # by sizes: smaller differences are round-off of places and sums
_SEED = 82
_WEIGHTS = (0.37, 0.11, 0.73, 0.29)  # arbitrary numbers that distinguish laws of contact


@dataclass(frozen=True)
class Mirror:
    """Mirror image of velocities, ``signs * u[places]``; both of shape (n,)."""

    places: Ints
    signs: Floats

    def of(self, velocity: Floats) -> Floats:
        """Return the mirror image of velocities, or of the forces on them, (n,) or (n, m)."""
        signs = self.signs if velocity.ndim == 1 else self.signs[:, None]
        return np.asarray(signs * velocity[self.places])


def senses(even: bool, stated: Sequence[Discretisation]) -> Floats:
    """Return the signs of components that do not change whether loads are carried, (s, k).

    The first signs are 1. A structure may be symmetric about a vertical or horizontal axis. The
    mirror image of a component is then itself or its opposite, and any combination is carried if
    its image is. The symmetry is proven for the assembled program: each velocity and its image have
    the same flow, contact and supports. This is tested by a random velocity, because different rows
    agree on it with probability 0. It is limited to uniform properties: strengths or forces that
    vary with place are excluded.

    Args:
        even: whether opposite loads are equivalent.
        stated: the problem with each of the components as its reference loads, (k,).
    """
    k = len(stated)
    found = {(1.0,) * k}
    if even:
        found.add((-1.0,) * k)
    if _uniform(stated):
        for axis in (0, 1):
            signs = _signs(axis, stated)
            if signs is not None:
                found |= {tuple(np.multiply(one, signs).tolist()) for one in found}
    return np.array(sorted(found, reverse=True))


def _uniform(stated: Sequence[Discretisation]) -> bool:
    """Return whether all properties are uniform over each mesh."""
    problem = stated[0].problem
    criteria = [
        own.criterion for body in of_kind(problem.bodies, Body).values() for own in body.regions
    ]
    loads = [load for own in stated for load in own.problem.loads.values()]
    simple = all(map(_same_all_over, loads)) and not any(map(varying, criteria))
    return simple and not stated[0].frames and not stated[0].program.pressure_dependent


def _same_all_over(load: Load) -> bool:
    """Return whether a load is not water pressure, and does not vary with place."""
    return size_of(load) is not None and bool(getattr(load, "uniform", True))


def _signs(axis: int, stated: Sequence[Discretisation]) -> tuple[float, ...] | None:
    """Return the signs of components for a mirror across an axis; None without symmetry."""
    first = stated[0]
    mirror = _mirror(first, axis)
    if mirror is None or not _itself(first, mirror):
        return None
    signs = []
    for own in stated:
        force = own.full.reference_load
        image = mirror.of(force)
        sign = next((sign for sign in (1.0, -1.0) if _near(image, sign * force)), None)
        if sign is None:
            return None
        signs.append(sign)
    return tuple(signs)


def _mirror(own: Discretisation, axis: int) -> Mirror | None:
    """Return the mirror across the middle along an axis, if nodes and blocks are symmetric."""
    boxes = [body.box for body in own.problem.bodies.values()]
    middle = (min(low[axis] for low, _ in boxes) + max(high[axis] for _, high in boxes)) / 2
    size = max(body.size for body in own.problem.bodies.values())
    places, signs = np.full(own.full.n, -1), np.ones(own.full.n)
    for dofs in own.continua.values():
        pairs = _pairs(dofs.nodes.T, axis, middle, size)
        if pairs is None:
            return None
        places[dofs.dofs] = dofs.dofs[:, pairs]
        signs[dofs.dofs[axis]] = -1
    for blocks in own.assemblies.values():
        pairs = _pairs(blocks.body.centroid.T, axis, middle, size)
        if pairs is None:
            return None
        numbers = blocks.offset + np.arange(3 * len(pairs)).reshape(-1, 3)
        places[numbers] = numbers[pairs]
        signs[numbers[:, [axis, 2]]] = -1  # Rotations are reversed.
    return None if np.any(places < 0) else Mirror(places, signs)


def _pairs(places: Floats, axis: int, middle: float, size: float) -> Ints | None:
    """Return the number of the image of each place, (m, 2); None if one has no image."""
    image = places.copy()
    image[:, axis] = 2 * middle - image[:, axis]
    far, pairs = KDTree(places).query(image)
    own = np.unique(pairs).size == len(places)
    return np.asarray(pairs) if own and np.all(far <= _SAME * size) else None


def _itself(own: Discretisation, mirror: Mirror) -> bool:
    """Return whether velocities and their images have equal flow, contact, supports and loads."""
    full = own.full
    velocity = np.random.default_rng(_SEED).normal(size=full.n)
    image = mirror.of(velocity)
    alike = [
        _near(mirror.of(full.dead_load), full.dead_load),
        _held(own.free_basis, velocity, mirror),
    ]
    for group in full.groups:
        strong = group.weights * group.bound
        rates = [np.linalg.norm(group.cone_vectors(one), axis=1) for one in (velocity, image)]
        alike += [_as_sets(*rates), _as_sets(*(strong * rate for rate in rates))]
    if full.contact.count:
        alike.append(_as_sets(*(_touching(one, full.contact) for one in (velocity, image))))
    return all(alike)


def _touching(velocity: Floats, contact: ContactRows) -> Floats:
    """Return a number for each contact point that identifies its motion and its law."""
    normal = np.asarray(contact.normal @ velocity)
    slip = np.asarray(contact.tangential @ velocity).reshape(contact.count, -1)
    limit = np.where(np.isinf(contact.limit), -1.0, contact.limit)
    laws = (contact.coefficient, limit, contact.dilatancy, contact.pull)
    law = sum(weight * _per_largest(own) for weight, own in zip(_WEIGHTS, laws, strict=True))
    moved = normal + np.pi * np.linalg.norm(slip, axis=1)
    return np.asarray(contact.weights * moved * (1 + law))


def _per_largest(values: Floats) -> Floats:
    return values / (np.abs(values).max() or 1.0)


def _held(free: Sparse, velocity: Floats, mirror: Mirror) -> bool:
    """Return whether the image of a random free motion is a free motion."""
    squares = csc_matrix(free.T @ free)
    moved = mirror.of(free @ spsolve(squares, free.T @ velocity))
    return _near(free @ spsolve(squares, free.T @ moved), moved)


def _as_sets(one: Floats, other: Floats) -> bool:
    return _near(np.sort(one), np.sort(other))


def _near(one: Floats, other: Floats) -> bool:
    return bool(np.abs(one - other).max(initial=0.0) <= _SAME * np.abs(one).max(initial=0.0))
