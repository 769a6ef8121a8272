"""Search for low and high load factors of soils whose flow is not associated (T57, T59).

Their limit states are not unique: a small gap proves a state, and says nothing of others. So
several searches start from stresses that are admissible, those of the same soil with all of its
friction or a share of it, and settle by S-steps, which stay near where they start, or drift by
K-steps first, which end at lower loads. What they find is certified; that there is nothing
lower or higher they do not prove.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.coupling.certified import anchored
from lacore.coupling.deadline import OutOfTime
from lacore.coupling.freezing import Frozen, associated, frictionless
from lacore.coupling.run import Iterate, Run
from lacore.coupling.settling import drifted, settled
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status

SEARCHES = {"settled": settled, "drifted": drifted}


@dataclass(frozen=True, repr=False)
class SoilFound(Compact):
    """End of one search.

    Attributes:
        share: of its friction that the soil had where it starts.
        search: one of `SEARCHES`.
        start: the solve for the stresses that it starts from.
        iterates: the inner solves after it.
        final: the pair with the least residual; None where there is none, or none proves.
    """

    share: float
    search: str
    start: Iterate
    iterates: tuple[Iterate, ...]
    final: Iterate | None


def soil_bounds(run: Run) -> tuple[float, float]:
    """Bounds of all load factors of a program, by two problems with associated flow (T54)."""
    program, tolerance = run.program, run.options.tolerance
    above, below = associated(program), frictionless(program)
    answers = [run.solve("bound", one.contact, program=one.program).inner for one in (below, above)]
    run.iterates.clear()
    return (
        lower_bound(below.program, answers[0], tolerance),
        upper_bound(above.program, answers[1], tolerance),
    )


def soil_states(run: Run, shares: tuple[float, ...]) -> Iterator[SoilFound]:
    """The ends of all searches, as they are found.

    Args:
        run: without iterates yet; its options say what is proven, and what is accepted.
        shares: of its friction that a soil has where searches start.

    Raises:
        OutOfTime: by its `on_iterate`; after what the search at work has found so far.
    """
    for share in shares:
        frozen = _with_share(run.program, share)
        start = run.solve("associated", frozen.contact, program=frozen.program)
        if start.inner.status is Status.LOCKED:  # no dilatant soil moves here, and others may
            start = anchored(run)
        for name, search in SEARCHES.items():
            own = run.afresh([start])
            over: OutOfTime | None = None
            if start.inner.point is not None:
                try:
                    search(own, start.inner.point)
                except OutOfTime as raised:
                    over = raised
            final = own.best_proven() if own.relax_tolerance() else None
            yield SoilFound(share, name, own.iterates[0], tuple(own.iterates[1:]), final)
            if over is not None:
                raise over


def _with_share(program: KinematicProgram, share: float) -> Frozen:
    """The associated problem with a share of the friction of soils, their apex kept."""

    def weaker(group: DissipationGroup) -> DissipationGroup:
        if group.surfaces is None or not group.frictional:
            return group
        own = group.surfaces.associated()
        surfaces = replace(own, slope=share * own.slope, strength=share * own.strength)
        return replace(group, surfaces=surfaces)

    frozen = associated(program)
    return replace(
        frozen, program=replace(frozen.program, groups=tuple(map(weaker, program.groups)))
    )
