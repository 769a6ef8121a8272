"""Contact interfaces and their friction laws (T2, T4).

Sign conventions. `n` is the unit normal from the master (obstacle) into the slave body; the
relative velocity is that of the slave against the master, ``u_n > 0`` opens. Tractions act on the
slave, ``t_n > 0`` is compression.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeGuard

from lacore.model.conditions.where import Where, where_name
from lacore.model.contact.obstacles import RigidObstacle, Shape
from lacore.model.materials.friction import Bonded, Friction, friction_law
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import join, text


@dataclass(frozen=True, repr=False)
class Interface(Compact):
    """Contact between a boundary and a rigid obstacle, or between the boundaries of two bodies.

    The choice of the slave has no effect on results, except for the signs of
    `LimitState.reactions`.

    Attributes:
        slave: ``(body name, where)``, see `lacore.types.Where`; it ends at vertices of facets.
        master: a `RigidObstacle`, or ``(body name, where)`` of another body. The two boundaries
            touch along straight parts; their meshes need not match. Along a path it may be another
            part of the same body, see `lacore.sequential`.
        friction: coefficient of Coulomb friction, or `Coulomb`, `Tresca`, `SMOOTH`, `STICK`,
            `BOND`. STICK forbids slip at any opening, also after lift-off, but opens freely,
            without tension: the limit mu -> infinity of associated friction, not of
            Coulomb friction. No body carries more shear than its strength: see
            `lacore.assembly.sticking` for corners. BOND also transfers tension, up to the strength
            of the weaker side, and joins rigid bodies: see `lacore.assembly.bonds`.

    Raises:
        InputError: a negative or NaN friction, a master of another kind.

    Example:
        >>> floor = la.RigidObstacle(point=(0, 0), normal=(0, 1))
        >>> foot = la.Interface(slave=("block", "bottom"), master=floor, friction=0.3)
    """

    slave: tuple[str, Where]
    master: RigidObstacle | tuple[str, Where]
    friction: float | Friction

    def __post_init__(self) -> None:
        if not _is_boundary(self.slave):
            raise InputError(
                "Interface.slave", self.slave, "not a boundary", "give (body name, where)"
            )
        if not (isinstance(self.master, RigidObstacle) or _is_boundary(self.master)):
            raise InputError(
                "Interface.master",
                self.master,
                "not an obstacle or a boundary",
                "give lacore.RigidObstacle() or (body name, where)",
            )
        object.__setattr__(self, "friction", self.law)

    @property
    def obstacle(self) -> RigidObstacle | None:
        """The master if it is an obstacle."""
        return self.master if isinstance(self.master, RigidObstacle) else None

    @property
    def face(self) -> Shape | None:
        """Shape of the obstacle; None for a body, or if it follows the boundary."""
        return None if self.obstacle is None else self.obstacle.face

    @property
    def sides(self) -> tuple[tuple[str, Where], ...]:
        """Boundaries of bodies: the slave, and the master if it is a body."""
        return (self.slave, self.master) if _is_boundary(self.master) else (self.slave,)

    @property
    def law(self) -> Friction:
        """The friction law, a bare coefficient read as Coulomb friction."""
        return friction_law(self.friction, "Interface.friction")

    @property
    def self_contact(self) -> bool:
        """Whether both sides belong to one body."""
        return len({name for name, _ in self.sides}) < len(self.sides)

    @property
    def bonded(self) -> bool:
        """Whether it neither opens nor slips, up to the strength of the weaker side."""
        return isinstance(self.law, Bonded)

    @property
    def name(self) -> str:
        """Name in tables: ``block.bottom``, ``punch.base|soil.top``."""
        return join("|", (text("{}.{}", body, where_name(where)) for body, where in self.sides))


def _is_boundary(side: object) -> TypeGuard[tuple[str, Where]]:
    return isinstance(side, tuple) and len(side) == 2 and isinstance(side[0], str)
