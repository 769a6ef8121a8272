"""Mirrors of a structure: loads that it carries alike, proven of its assembled program (T82)."""

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

_SAME = 1e-9  # of sizes: what differs by less is round-off of places and sums
_SEED = 82
_WEIGHTS = (0.37, 0.11, 0.73, 0.29)  # any numbers: they tell laws of contact apart


@dataclass(frozen=True)
class Mirror:
    """Velocities seen in a mirror, ``signs * u[places]``; both of shape (n,)."""

    places: Ints
    signs: Floats

    def of(self, velocity: Floats) -> Floats:
        """The mirror image of velocities, or of the forces on them, (n,) or (n, m)."""
        signs = self.signs if velocity.ndim == 1 else self.signs[:, None]
        return np.asarray(signs * velocity[self.places])


def senses(even: bool, stated: Sequence[Discretisation]) -> Floats:
    """Signs of components that leave what is carried as it is, shape (s, k); the first are 1.

    In a mirror, upright or level, a structure may be itself. A component then is itself, too, or
    its opposite, and any combination is carried as its image is. That it is itself is proven of the
    assembled program: each velocity and its image flow, touch and are held alike, which is seen by
    a random one, as different rows agree on it with probability 0. Only of what is as uniform as
    its mesh shows: no strengths or forces that vary from place to place.

    Args:
        even: whether opposite loads are carried alike.
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
    """Whether a mesh shows all that there is: values that are the same all over its elements."""
    problem = stated[0].problem
    criteria = [
        own.criterion for body in of_kind(problem.bodies, Body).values() for own in body.regions
    ]
    loads = [load for own in stated for load in own.problem.loads.values()]
    simple = all(map(_same_all_over, loads)) and not any(map(varying, criteria))
    return simple and not stated[0].frames and not stated[0].program.pressure_dependent


def _same_all_over(load: Load) -> bool:
    """Whether it is no pressure of water, and no force that varies from place to place."""
    return size_of(load) is not None and bool(getattr(load, "uniform", True))


def _signs(axis: int, stated: Sequence[Discretisation]) -> tuple[float, ...] | None:
    """Of components in a mirror across an axis; None where the structure has no such mirror."""
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
    """Across the middle of all along an axis, if nodes and blocks lie alike on both sides."""
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
        signs[numbers[:, [axis, 2]]] = -1  # what turns turns the other way round
    return None if np.any(places < 0) else Mirror(places, signs)


def _pairs(places: Floats, axis: int, middle: float, size: float) -> Ints | None:
    """The number of the image of each place, (m, 2); None where one has none of its own."""
    image = places.copy()
    image[:, axis] = 2 * middle - image[:, axis]
    far, pairs = KDTree(places).query(image)
    own = np.unique(pairs).size == len(places)
    return np.asarray(pairs) if own and np.all(far <= _SAME * size) else None


def _itself(own: Discretisation, mirror: Mirror) -> bool:
    """Whether velocities and their images flow, touch, are held and are driven alike."""
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
    """A number for each contact point that tells its motion and its law."""
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
    """Whether the image of a motion that supports leave, nearest to a random one, is such a one."""
    squares = csc_matrix(free.T @ free)
    moved = mirror.of(free @ spsolve(squares, free.T @ velocity))
    return _near(free @ spsolve(squares, free.T @ moved), moved)


def _as_sets(one: Floats, other: Floats) -> bool:
    return _near(np.sort(one), np.sort(other))


def _near(one: Floats, other: Floats) -> bool:
    return bool(np.abs(one - other).max(initial=0.0) <= _SAME * np.abs(one).max(initial=0.0))
