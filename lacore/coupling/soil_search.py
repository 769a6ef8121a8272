"""Search for low and high load factors of soils with non-associated flow (T57, T59).

Limit states of these soils are not unique: a small gap proves one state and nothing about others.
Several searches therefore start from admissible stresses of the same soil with all or a share of
its friction. They converge by S-steps, which stay close to their start, or take K-steps first,
which drift to lower loads. All states that they find are certified, but lower or higher load
factors may exist.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.coupling.certified import anchored
from lacore.coupling.freezing import Frozen, associated, frictionless
from lacore.coupling.run import Iterate, OutOfTime, Run
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
        share: Share of the friction of the soil at the start.
        search: Name of the search, see `SEARCHES`.
        start: Solve for the stresses at the start.
        iterates: Inner solves after the start.
        final: Proven pair with the least residual; None without one.
    """

    share: float
    search: str
    start: Iterate
    iterates: tuple[Iterate, ...]
    final: Iterate | None


def soil_bounds(run: Run) -> tuple[float, float]:
    """Return bounds of all load factors, by two problems with associated flow (T54)."""
    program, tolerance = run.program, run.options.tolerance
    above, below = associated(program), frictionless(program)
    answers = [run.solve("bound", one.contact, program=one.program).inner for one in (below, above)]
    run.iterates.clear()
    return (
        lower_bound(below.program, answers[0], tolerance),
        upper_bound(above.program, answers[1], tolerance),
    )


def soil_states(run: Run, shares: tuple[float, ...]) -> Iterator[SoilFound]:
    """Yield the ends of all searches.

    Args:
        run: Run without iterates; its options contain the tolerance and the accepted one.
        shares: Shares of the friction of a soil at which searches start.

    Raises:
        OutOfTime: Its `on_iterate` raised it; the result of the current search is yielded before.
    """
    for share in shares:
        frozen = _with_share(run.program, share)
        start = run.solve("associated", frozen.contact, program=frozen.program)
        if start.inner.status is Status.LOCKED:  # with less dilation a mechanism may exist
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
    """Return the associated problem with a share of the friction of soils and the same apex."""

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
