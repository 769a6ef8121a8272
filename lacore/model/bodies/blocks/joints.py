"""Joints of rigid blocks: shared segments of outlines, and their friction laws."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lacore.model.bodies.blocks.polygons import BlockEdges
from lacore.model.bodies.touching import Shared, touching
from lacore.model.materials.friction import BOND, Friction, friction_law
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, suggest
from lacore.reporting.showing import Compact

JointFriction = Mapping[tuple[str, str], float | Friction]
"""Laws of single joints, by the names of their two blocks."""


@dataclass(frozen=True, eq=False, repr=False)
class Joints(Compact):
    """Shared segments of two blocks each, with their friction (T2, T4).

    Attributes:
        slave, master: block numbers, (J,); the master comes first in the assembly.
        slave_edge, master_edge: edge numbers, (J,).
        start, end: the segment along the edge of the slave, on it up to the gap, (2, J), m.
        normal: unit normal from the master into the slave, (2, J).
        coefficient, limit, dilatancy, tension: parameters of ``||t_t|| <= coefficient t + limit``,
            ``t = t_n +
            tension >= 0`` (limit and tension in Pa) and ``u_n >= dilatancy ||u_t||``, (J,).
    """

    slave: Ints
    master: Ints
    slave_edge: Ints
    master_edge: Ints
    start: Floats
    end: Floats
    normal: Floats
    coefficient: Floats
    limit: Floats
    dilatancy: Floats
    tension: Floats

    @property
    def count(self) -> int:
        """Number of joints."""
        return self.slave.size

    @property
    def length(self) -> Floats:
        """Lengths (J,), m."""
        return np.asarray(np.linalg.norm(self.end - self.start, axis=0))


def joint_law(friction: float | Friction, field: str) -> Friction:
    """Return a friction law of joints; rigid blocks have no bonds."""
    law = friction_law(friction, field)
    if law == BOND:
        raise InputError(
            field,
            "BOND",
            "rigid blocks have no strength at which a bond could break",
            "make what never parts one block, or two bodies with a bonded Interface; or give a"
            " friction",
        )
    return law


def find_joints(
    names: Sequence[str],
    edges: BlockEdges,
    friction: Friction,
    joint_friction: JointFriction,
    tolerance: float,
    field: str,
) -> Joints:
    """Return the joints of all blocks, sorted along the edges of their slaves.

    Raises:
        InputError: a pair in `joint_friction` that is given twice, unknown, or has no joint; an
            invalid law.
    """
    shared, normal = _joined(edges, tolerance)
    slave, master = edges.block[shared.first], edges.block[shared.second]
    terms = joint_terms(names, slave, master, friction, joint_friction, field)
    return Joints(
        slave,
        master,
        shared.first,
        shared.second,
        shared.start,
        shared.end,
        normal,
        *terms,
    )


def joint_terms(
    names: Sequence[str],
    slave: Ints,
    master: Ints,
    friction: Friction,
    joint_friction: JointFriction,
    field: str,
) -> Floats:
    """Return coefficient, limit, dilatancy and tension of joints, shape (4, J).

    Args:
        names: names of blocks.
        slave, master: blocks of each joint, (J,); the number of the slave is the larger one.
        friction: law of all joints.
        joint_friction: laws of single pairs.
        field: name of these, for messages.

    Raises:
        InputError: a pair that is given twice, unknown, or has no joint; an invalid law.
    """
    pair = slave * len(names) + master
    order = np.argsort(pair, kind="stable")
    wanted, laws = _by_pair(names, joint_friction, field)
    first = np.searchsorted(pair[order], wanted, side="left")
    count = np.searchsorted(pair[order], wanted, side="right") - first
    if np.any(count == 0):
        without = list(joint_friction)[np.flatnonzero(count == 0)[0]]
        raise InputError(field, without, "these blocks share no joint", "remove the entry")
    # Positions of all joints of all pairs: the first one of each pair, and those after it.
    behind = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    special = order[np.repeat(first, count) + behind]

    terms = np.empty((4, slave.size))
    terms[:] = np.reshape(_coefficients(friction), (4, 1))
    if laws:
        terms[:, special] = np.repeat(np.transpose([_coefficients(law) for law in laws]), count, 1)
    return terms


def _joined(edges: BlockEdges, tolerance: float) -> tuple[Shared, Floats]:
    """Return segments by the edges of slaves and masters, and normals from masters into slaves.

    The coordinates of a pair are those of the same edge, whichever block is listed first, so that
    its order does not change even the last digit.
    """
    shared = touching(edges, edges, tolerance)
    places = np.stack([np.bincount(edges.block, own) for own in edges.start])
    rank = np.empty(places.shape[1], dtype=np.int64)
    rank[np.lexsort(places)] = np.arange(rank.size)
    one, other = edges.block[shared.first], edges.block[shared.second]
    shared = shared.take(rank[one] > rank[other])
    slave = edges.block[shared.first] > edges.block[shared.second]  # slave is the first of the pair
    joined = Shared(
        np.where(slave, shared.first, shared.second),
        np.where(slave, shared.second, shared.first),
        np.where(slave, shared.start, shared.end),
        np.where(slave, shared.end, shared.start),
        shared.gap,
    )
    normal = np.where(slave, -1.0, 1.0) * edges.normal[:, shared.first]
    own = joined.first
    along = np.sum((joined.start - edges.start[:, own]) * (edges.end - edges.start)[:, own], axis=0)
    order = np.lexsort((along, own))
    return joined.take(order), normal[:, order]


def joint_names(names: Sequence[str], master: Ints, slave: Ints) -> tuple[str, ...]:
    """Return names ``master|slave``, and ``master|slave#2`` for a second joint of two blocks."""
    met: dict[tuple[int, int], int] = {}
    labels = []
    for pair in zip(master.tolist(), slave.tolist(), strict=True):
        met[pair] = met.get(pair, 0) + 1
        label = f"{names[pair[0]]}|{names[pair[1]]}"
        labels.append(label if met[pair] == 1 else f"{label}#{met[pair]}")
    return tuple(labels)


def _coefficients(law: Friction) -> tuple[float, float, float, float]:
    terms = law.terms()
    return terms.coefficient, terms.limit, terms.dilatancy, terms.tension


def _by_pair(
    names: Sequence[str], joint_friction: JointFriction, field: str
) -> tuple[Ints, list[Friction]]:
    """Return the pair numbers as in `find_joints`, and laws."""
    number = {name: n for n, name in enumerate(names)}
    laws: dict[int, Friction] = {}
    if not isinstance(joint_friction, Mapping):
        raise InputError(field, joint_friction, "no mapping", "give {('a', 'b'): friction}")
    for pair, friction in joint_friction.items():
        if not (isinstance(pair, tuple) and len(pair) == 2):
            raise InputError(field, pair, "not a pair of blocks", "give {('a', 'b'): friction}")
        for name in pair:
            if name not in number:
                raise InputError(field, pair, "no such block", suggest(str(name), names))
        low, high = sorted(number[name] for name in pair)
        key = high * len(names) + low
        if key in laws:
            raise InputError(field, pair, "this joint is given twice", "give one order of it only")
        laws[key] = joint_law(friction, f"{field}[{pair!r}]")
    return np.array(list(laws), dtype=np.int64), list(laws.values())
