"""Programs of random rows without a mesh: all cones and contacts that backends support."""

import numpy as np
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore_verification.fuzz.drawn.draw import Rng

_FAR = 12  # Largest distance in node numbers between nodes of a cone.


def chains(rng: Rng, size: int) -> tuple[KinematicProgram, FrozenContact]:
    """Return nodes of two or three velocities, coupled to previous nodes by cones of random rows.

    Some harden, a few keep a volume; some nodes touch obstacles with friction, stick, dilatancy or
    a gap.
    """
    dim = int(rng.integers(2, 4))
    count = max(size // dim, 2)
    n = dim * count
    groups = [_ties(rng, count, dim, int(rng.integers(1, 7)), n) for _ in range(2)]
    contact = _touching(rng, count, dim, n)
    m = contact.count
    load = rng.normal(size=n)
    dead = 0.02 * rng.normal(size=n) * (rng.uniform() < 0.5)
    some = rng.uniform(size=m)
    bound = np.where(some < 0.1, np.inf, np.where(some < 0.4, 0.0, rng.uniform(0, 2, m)))
    dilates = np.where(rng.uniform(size=m) < 0.4, rng.uniform(0.05, 1, m), 0.0)
    shift = np.where(rng.uniform(size=m) < 0.4, rng.uniform(0, 0.3, m), 0.0)
    program = KinematicProgram(tuple(groups), contact, load / np.linalg.norm(load), dead)
    return program, FrozenContact(bound, dilates, shift)


def _ties(rng: Rng, count: int, dim: int, rows: int, n: int) -> DissipationGroup:
    """Return a cone at each node, on it and a previous one, or the ground."""
    node = np.arange(count)
    back = node - rng.integers(1, _FAR, count)
    volumes = rng.uniform(size=count) < 0.1
    return DissipationGroup(
        name=f"ties of {rows}",
        rows=_between(rng, node, back, dim, rows, n),
        dim=rows,
        weights=rng.uniform(0.2, 1, count),
        bound=rng.uniform(0.5, 2, count),
        volumetric=csr_matrix(_between(rng, node, back, dim, 1, n).multiply(volumes[:, None])),
        volumetric_factor=1 / np.sqrt(3),
        modulus=rng.uniform(0, 1, count) if rng.uniform() < 0.2 else None,
    )


def _touching(rng: Rng, count: int, dim: int, n: int) -> ContactRows:
    """Return contact of some nodes with obstacles, with random normals."""
    node = np.flatnonzero(rng.uniform(size=count) < 0.2)
    frames = np.linalg.qr(rng.normal(size=(node.size, dim, dim)))[0]
    columns = dim * node[:, None] + np.arange(dim)
    tangents = dim - 1
    normal = _placed(frames[:, :1].reshape(-1, dim), columns, n)
    slip = frames[:, 1:].reshape(-1, dim)
    zero = np.zeros(node.size)
    return ContactRows(
        normal=normal,
        tangential=_placed(slip, np.repeat(columns, tangents, axis=0), n),
        tangent_dim=tangents,
        weights=rng.uniform(0.2, 1, node.size),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )


def _between(rng: Rng, node: Ints, back: Ints, dim: int, rows: int, n: int) -> Sparse:
    """Return random rows of the difference of two nodes.

    Of the node alone without a previous one.
    """
    turns = rng.normal(size=(node.size, rows, dim))
    columns = np.repeat((dim * node[:, None] + np.arange(dim))[:, None], rows, axis=1)
    own = _placed(turns.reshape(-1, dim), columns.reshape(-1, dim), n)
    tied = (back >= 0)[:, None, None]
    other = dim * np.maximum(back, 0)[:, None] + np.arange(dim)
    columns = np.repeat(other[:, None], rows, axis=1).reshape(-1, dim)
    return csr_matrix(own - _placed((turns * tied).reshape(-1, dim), columns, n))


def _placed(values: Floats, columns: Ints, n: int) -> Sparse:
    """Return rows with given values in given columns, both of shape (rows, k)."""
    row = np.repeat(np.arange(len(values)), values.shape[1])
    made: Sparse = csr_matrix((values.ravel(), (row, columns.ravel())), (len(values), n))
    made.eliminate_zeros()
    return made
