"""The couplings: how each treats friction without dilation, and what its load factors bound.

Help texts list them, so that nothing else is loaded here: functions are named ``module:name``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Literal

from lacore.reporting.errors import InputError

if TYPE_CHECKING:
    from lacore.coupling.run import Coupled, Run
    from lacore.program.kinematic import ContactRows, FrozenContact, KinematicProgram
    from lacore.solvers.backend import Backend

_DILATING = "lacore.program.kinematic:associated_contact"
_ASSOCIATED = "lacore.program.kinematic:KinematicProgram.associated"


@dataclass(frozen=True)
class CouplingKind:
    """A way to treat Coulomb friction and non-associated flow.

    Attributes:
        name: Name, as in `lacore.solve`.
        loop: Function that iterates on a `Run`; empty for a single solve with `laws`.
        program: Function that returns the program of a single solve; empty for the given program.
        laws: Function that returns the contact laws of a single solve, by which its states are
            judged; empty for the given friction laws.
        model: Name of the model that a single solve puts in place of the given one.
        bounds: Side on which the load factor bounds all Coulomb load factors (T14).
        needs_exact: Whether it needs exact multipliers, which regularised backends do not return.
    """

    name: str
    loop: str = ""
    program: str = ""
    laws: str = ""
    model: str = ""
    bounds: Literal["", "upper", "lower"] = ""
    needs_exact: bool = False

    @property
    def dilates(self) -> bool:
        """Whether sliding on Coulomb friction opens the contact."""
        return self.laws == _DILATING

    @property
    def may_be_stronger(self) -> bool:
        """Whether its model may carry loads that the given problem does not carry."""
        return bool(self.model) and self.bounds != "lower"

    @property
    def may_be_weaker(self) -> bool:
        """Whether its model may collapse under loads that the given problem carries."""
        return bool(self.model) and self.bounds != "upper"

    def run(self, run: Run) -> Coupled:
        """Solve a run, whose program must be that of `program_of`."""
        if self.loop:
            loop: Callable[[Run], Coupled] = resolve_name(self.loop)
            return loop(run)
        laws = self.laws_of(run.program.contact)
        assert laws is not None
        return run.finish(run.solve(self.name, laws, laws), laws)

    def program_of(self, program: KinematicProgram) -> KinematicProgram:
        """Return the program that is solved, with the flow of its soils as the coupling takes it.

        Raises:
            InputError: Davis's strength of a program with associated flow.
        """
        if not self.program:
            return program
        make: Callable[[KinematicProgram], KinematicProgram] = resolve_name(self.program)
        return make(program)

    def laws_of(self, rows: ContactRows) -> FrozenContact | None:
        """Return the contact laws by which states are judged; None for the given laws."""
        if not self.laws:
            return None
        make: Callable[[ContactRows], FrozenContact] = resolve_name(self.laws)
        return make(rows)


CERTIFIED, REACTION, ASSOCIATED = "certified", "reaction", "associated"
DEFAULT, DEFAULT_REGULARISED = CERTIFIED, REACTION
_KINDS = (
    CouplingKind(CERTIFIED, "lacore.coupling.certified:certified_loop", needs_exact=True),
    CouplingKind(REACTION, "lacore.coupling.fixed_point:reaction_loop"),
    CouplingKind("shift", "lacore.coupling.fixed_point:shift_loop", needs_exact=True),
    CouplingKind(
        ASSOCIATED,
        program=_ASSOCIATED,
        laws=_DILATING,
        model=ASSOCIATED,
        bounds="upper",
    ),
    CouplingKind(
        "frictionless",
        program="lacore.coupling.freezing:without_friction",
        laws="lacore.program.kinematic:frictionless_contact",
        model="no friction",
        bounds="lower",
    ),
    CouplingKind(
        "stick",
        program=_ASSOCIATED,
        laws="lacore.program.kinematic:stick_contact",
        model="no slip",
        bounds="upper",
    ),
    CouplingKind(
        "davis",
        program="lacore.coupling.freezing:davis",
        laws=_DILATING,
        model="Davis's strength",
    ),
)
COUPLINGS: Mapping[str, CouplingKind] = {kind.name: kind for kind in _KINDS}
"""All couplings by name, in the order in which help texts list them."""


def coupling_for(backend: Backend, coupling: str | None) -> str:
    """Return the requested coupling, or the default one of a backend.

    Raises:
        InputError: The backend is regularised, and the coupling needs exact multipliers.
    """
    if not backend.capabilities.regularised:
        return coupling or DEFAULT
    if coupling is not None and COUPLINGS[coupling].needs_exact:
        raise InputError(
            "coupling",
            coupling,
            f"needs exact solves, and backend {backend.name!r} is regularised",
            "take 'reaction', of contact alone, or an exact backend such as 'clarabel'",
        )
    return coupling or DEFAULT_REGULARISED
