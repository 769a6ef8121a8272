"""Programs with analytical solutions, and their building blocks.

Contact points are on a plane that rises at 3 in 4: unit normal n = (-0.6, 0.8) away from it, unit
tangent t = (0.8, 0.6) up it, so that nothing is parallel to an axis. A body on it weighs W = 5,
that is 4 against the plane and 3 down it; its contact length is L = 2, so F = L g is its friction.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_matrix

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties
from lacore.reporting.status import Status

W, LENGTH = 5.0, 2.0
NORMAL, UPWARD = (-0.6, 0.8), (0.8, 0.6)
WEIGHT = (0.0, -W)


@dataclass(frozen=True)
class Worked:
    """Program with its solution. None means not unique, or unknown.

    Attributes:
        name: name of the program.
        hand: the analytical solution.
        program, contact: arguments of the backend.
        status: required status.
        load_factor: alpha, the multiplier of ``F0.U = 1``.
        velocity: U, shape (n,).
        stress: stresses of each group, shape (m, dim).
        mean_stress: mean stresses of each group, shape (m,).
        normal_reaction, tangential_reaction: t_n, shape (m,), and t_t, shape (m, tangent_dim).
        isostatic: equilibrium and the yielding cones alone give the load factor, the stresses and
            the reactions, so that they do not depend on viscosity and penalties.
        softened: load factor of the regularised program for given penalties, if it is known.
        unsoftened: why no regularised law has this behaviour; empty if one does.
    """

    name: str
    hand: str
    program: KinematicProgram
    contact: FrozenContact
    status: Status = Status.SOLVED
    load_factor: float | None = None
    velocity: npt.ArrayLike | None = None
    stress: tuple[Any, ...] | None = None
    mean_stress: tuple[Any, ...] | None = None
    normal_reaction: npt.ArrayLike | None = None
    tangential_reaction: npt.ArrayLike | None = None
    isostatic: bool = True
    softened: Callable[[Penalties], float] | None = None
    unsoftened: str = ""


def cones(
    rows: npt.ArrayLike,
    weights: Sequence[float],
    bounds: Sequence[float],
    volumetric: npt.ArrayLike | None = None,
    factor: float = 1 / np.sqrt(3),
    name: str = "body",
) -> DissipationGroup:
    """Return a group of cones; rows of shape (m, dim, n), volumetric (m, n), by default zeros."""
    stacked = np.asarray(rows, dtype=float)
    count, dim, n = stacked.shape
    theta = np.zeros((count, n)) if volumetric is None else np.asarray(volumetric, dtype=float)
    return DissipationGroup(
        name=name,
        rows=csr_matrix(stacked.reshape(count * dim, n)),
        dim=dim,
        weights=np.array(weights, dtype=float),
        bound=np.array(bounds, dtype=float),
        volumetric=csr_matrix(theta),
        volumetric_factor=factor,
    )


def points(
    normal: npt.ArrayLike, tangential: npt.ArrayLike, weights: Sequence[float]
) -> ContactRows:
    """Return contact points; rows of shape (m, n) and (m, tangent_dim, n), with frozen laws."""
    n_rows, t_rows = np.asarray(normal, dtype=float), np.asarray(tangential, dtype=float)
    count, dim, n = t_rows.shape
    zero = np.zeros(count)
    return ContactRows(
        normal=csr_matrix(n_rows),
        tangential=csr_matrix(t_rows.reshape(count * dim, n)),
        tangent_dim=dim,
        weights=np.array(weights, dtype=float),
        coefficient=zero,
        limit=zero,
        dilatancy=zero,
        interface=zero.astype(int),
    )


def nowhere(n: int) -> ContactRows:
    """Return a contact without points, for n unknowns."""
    return points(np.zeros((0, n)), np.zeros((0, 1, n)), [])


def program(
    groups: Sequence[DissipationGroup],
    contact: ContactRows,
    reference: Sequence[float] | Floats,
    dead: Sequence[float] | Floats | None = None,
) -> KinematicProgram:
    """Return a program in which every unit is 1."""
    load = np.array(reference, dtype=float)
    weight = np.zeros(load.size) if dead is None else np.array(dead, dtype=float)
    return KinematicProgram(tuple(groups), contact, load, weight)


def frozen(
    bound: Sequence[float] = (), dilatancy: float = 0.0, shift: float = 0.0
) -> FrozenContact:
    """Return frozen friction bounds, with one dilatancy and one shift for all points."""
    g = np.array(bound, dtype=float)
    return FrozenContact(g, np.full(g.size, dilatancy), np.full(g.size, shift))


def slope(
    reference: Sequence[float], dead: Sequence[float] = WEIGHT, copies: int = 1
) -> KinematicProgram:
    """Return a body on the plane, one contact point, no plasticity; or several, separately."""
    return program(
        [],
        points(
            np.kron(np.eye(copies), NORMAL),
            np.kron(np.eye(copies), UPWARD).reshape(copies, 1, 2 * copies),
            [LENGTH] * copies,
        ),
        reference,
        dead,
    )
