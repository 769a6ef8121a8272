"""Contact interfaces and their friction laws (T2, T4).

Sign conventions. `n` is the unit normal from the master (obstacle) into the slave body; the
relative velocity is that of the slave against the master, ``u_n > 0`` opens. Tractions act on the
slave, ``t_n >= 0`` is compression.
"""

from dataclasses import dataclass

from lacore.conditions.where import Where, where_name
from lacore.contact.obstacles import RigidObstacle
from lacore.errors import InputError
from lacore.materials.friction import Friction, friction_law
from lacore.showing import Compact


@dataclass(frozen=True, repr=False)
class Interface(Compact):
    """Contact between a boundary and a rigid obstacle, or between the boundaries of two bodies.

    Which of two bodies is called slave changes no result, only the signs of `LimitState.reactions`.

    Attributes:
        slave: ``(body name, where)``, see `lacore.bodies.continuum.boundaries.boundary_facets`.
        master: a `RigidObstacle`, or ``(body name, where)`` of another body. The two boundaries
            touch along straight parts; their meshes need not match.
        friction: coefficient of Coulomb friction, or `Coulomb`, `Tresca`, `SMOOTH`, `STICK`.
            STICK forbids slip wherever the body is, also where it lifts off, and opening is
            free: the limit mu -> infinity of associated friction, not of Coulomb friction. No
            body carries more shear than its strength: see `lacore.assembly.sticking` for corners.

    Raises:
        InputError: a negative or NaN friction, a master of another kind.
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
        if not isinstance(self.master, RigidObstacle) and self.master[0] == self.slave[0]:
            raise InputError(
                "Interface.master",
                self.master[0],
                "a body in contact with itself",
                "make its parts bodies of their own (blocks of one assembly find their joints)",
            )
        object.__setattr__(self, "friction", self.law)

    @property
    def law(self) -> Friction:
        """The friction law, a bare coefficient read as Coulomb friction."""
        return friction_law(self.friction, "Interface.friction")

    @property
    def name(self) -> str:
        """Name in tables: ``block.bottom``, ``punch.base|soil.top``."""
        sides = [self.slave]
        if not isinstance(self.master, RigidObstacle):
            sides.append(self.master)
        return "|".join(f"{body}.{where_name(where)}" for body, where in sides)


def _is_boundary(side: object) -> bool:
    return isinstance(side, tuple) and len(side) == 2 and isinstance(side[0], str)
