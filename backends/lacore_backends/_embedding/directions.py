"""Newton steps of the embedding: predictor, corrector, and Gondzio's correctors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_backends._embedding.cones import Compliance
from lacore_backends._embedding.frames import Frame
from lacore_backends._embedding.place import Place, Step, paired
from lacore_backends._embedding.system import Border, System
from lacore_backends._embedding.vectors import Vector

EXACT, MOST = 1e-5, 5
_MENDED = 0.1  # tolerance of a correction of the forces, by the residual of the solution
_AGAIN = 2  # number of corrections of a solution whose forces do not balance
_BALANCED = 0.1  # allowed residual of a step, by the unbalanced forces or the tolerance


@dataclass(frozen=True)
class _Reduced:
    """Right-hand sides of a direction after elimination of t (`lacore_backends._embedding.cones`).

    Attributes:
        right: right-hand side of `System`.
        leads: values for the t of costly cones.
        heights: ``W^2 dz + ds`` of each cone.
        kappa: right-hand side of ``tau dkappa + kappa dtau``.
    """

    right: Vector
    leads: tuple[Floats, ...]
    heights: Sequence[Floats]
    kappa: float


class Directions:
    """Newton steps from one iterate."""

    def __init__(self, place: Place, system: System) -> None:
        """Factorise the equations; raises `SingularError` if the stiffness is not definite."""
        conic, at = place.conic, place.at
        self._place, self._system = place, system
        self._loops = conic.equal.loops
        pairs = zip(place.slacks, place.multipliers, strict=True)
        self._scalings = [self._loops.scaled(s, z) for s, z in pairs]
        count = len(conic.costly)
        self._first = count + len(conic.free)  # index of the first cones of planes
        self._costly, self._free = self._scalings[:count], self._scalings[count : self._first]
        self._eliminated = [
            self._loops.eliminated(scaling, one.cost, one.rise, own[0], at.tau)
            for one, scaling, own in zip(conic.costly, self._costly, at.strained, strict=True)
        ]
        soft: list[Compliance | Frame] = []
        rates, slopes = [], []
        slope_tau = -place.rising / at.tau**2 - at.kappa / at.tau
        for one, scaling, own in zip(conic.costly, self._costly, self._eliminated, strict=True):
            soft.append(Compliance(scaling.square, own.rank, scaling.w[1:]))
            rates.append(one.cost * own.across)
            slopes.append(-own.slope * own.across)
            slope_tau += float(own.slope @ own.by_tau)
        soft += [Compliance.twice(scaling) for scaling in self._free]
        rates += [kind.offset for kind in conic.free]
        slopes += [kind.offset for kind in conic.free]
        for planes, both in paired(conic.planes, self._scalings[self._first :]):
            heavy = planes.multipliers(1.0, np.zeros((planes.rows.dim, planes.rows.count)))
            heavy = [Compliance.twice(one).times(z) for one, z in zip(both, heavy, strict=True)]
            by_tau = planes.summed(heavy)
            rates.append(by_tau.copy())
            rates[-1][planes.sheared :] -= planes.given
            slopes.append(-by_tau)
            slopes[-1][planes.sheared :] -= planes.given
            slope_tau -= planes.cost(heavy)
            soft.append(Frame.of(planes, both))
        border = Border(tuple(rates), tuple(slopes), slope_tau)
        heights = [-s for s in place.slacks]
        self._ahead = self._reduced(1.0, heights, -at.tau * at.kappa)
        self._start = system.factorise(soft, self._reference(), border, self._ahead.right)

    def _reference(self) -> float:
        """Return a compliance per squared norm of rows, typical of cones that dissipate power.

        A flowing cone has the compliance t/c across its direction and hardly any stiffness along
        it.
        """
        conic, place = self._place.conic, self._place
        count = len(conic.costly)
        softness = power = 0.0
        for one, scaling, own in zip(conic.costly, self._costly, place.at.strained, strict=True):
            share = one.cost * own[0]
            softness += float(np.sum(share * scaling.square / one.rows.norms))
            power += float(share.sum())
        for kind, scaling, s, z in zip(
            conic.free,
            self._free,
            place.slacks[count : self._first],
            place.multipliers[count : self._first],
            strict=True,
        ):
            if kind.dissipates:
                share = s[0] * z[0]
                softness += float(np.sum(share * scaling.square / kind.rows.norms))
                power += float(share.sum())
        for planes, scalings, s, z in zip(
            conic.planes,
            self._scalings[self._first :: 2],
            place.slacks[self._first :: 2],
            place.multipliers[self._first :: 2],
            strict=True,
        ):
            share = s[0] * z[0]
            norms = np.tile(planes.rows.norms, planes.normed)
            softness += float(np.sum(share * scalings.square / norms))
            power += float(share.sum())
        if softness > 0:
            return softness / power
        for kind, scaling, own in zip(
            conic.free, self._free, place.powers[count : self._first], strict=True
        ):
            softness += float(np.sum(own * scaling.square / kind.rows.norms))
            power += float(own.sum())
        return softness / power if softness > 0 else 1.0

    def _reduced(self, share: float, heights: Sequence[Floats], kappa: float) -> _Reduced:
        """Return the right-hand side of a step that removes a share of the residuals.

        Args:
            share: share of the residuals.
            heights: ``W^2 dz + ds`` of each cone.
            kappa: ``tau dkappa + kappa dtau``.
        """
        conic, left = self._place.conic, self._place.left
        count = len(conic.costly)
        right = self._system.layout.zeros()
        right.force[:] = -share * left.force
        right.equal[:] = -share * left.equal
        leads = tuple(
            self._loops.reduced(own, one.rise, height, missed, share, part)
            for one, own, height, missed, part in zip(
                conic.costly,
                self._eliminated,
                heights[:count],
                left.costly,
                right.costly,
                strict=True,
            )
        )
        pairs = zip(right.free, heights[count : self._first], left.free, strict=True)
        for part, height, missed in pairs:
            part[:] = height - share * missed
        of_planes = paired(conic.planes, heights[self._first :])
        for part, (planes, both), missed in zip(right.planes, of_planes, left.planes, strict=True):
            part[:] = planes.summed(both) - share * missed
        gap = -share * left.gap - kappa / self._place.at.tau
        gap -= sum(
            float(own.slope @ lead) for own, lead in zip(self._eliminated, leads, strict=True)
        )
        gap -= sum(planes.cost(cones) for planes, cones in of_planes)
        right.data[-2:] = -share * left.load, gap
        return _Reduced(right, leads, heights, kappa)

    def _roughly(self, given: _Reduced, start: Vector, left: Vector) -> "Directed":
        """Return the step from this start, and its residual."""
        plain, left = self._system.improved(given.right, start, left)
        x = self._system.along(plain, left)
        return Directed(self._step(given, x), given, x, plain, left)

    def _step(self, given: _Reduced, x: Vector) -> Step:
        """Return the full step for a solution of the equations."""
        conic, at = self._place.conic, self._place.at
        count, loops = len(conic.costly), self._loops
        strained = tuple(
            loops.strained(scaling, own, (one.cost, one.rise), (lead, height), x.tau, z)
            for one, scaling, own, lead, height, z in zip(
                conic.costly,
                self._costly,
                self._eliminated,
                given.leads,
                given.heights[:count],
                x.costly,
                strict=True,
            )
        )
        slacks = tuple(
            loops.flowed(own, height, r)
            for own, height, r in zip(
                self._free, given.heights[count : self._first], x.free, strict=True
            )
        )
        turned = [
            part
            for planes, zeta in zip(conic.planes, x.planes, strict=True)
            for part in planes.multipliers(x.tau, zeta)
        ]
        flows = tuple(
            loops.flowed(own, height, part)
            for own, height, part in zip(
                self._scalings[self._first :], given.heights[self._first :], turned, strict=True
            )
        )
        return Step(
            conic=conic,
            velocity=x.force,
            strained=strained,
            stresses=x.costly,
            equal=x.equal,
            slacks=slacks,
            pressures=x.free,
            flows=flows,
            bounded=x.planes,
            load=x.load,
            tau=x.tau,
            kappa=(given.kappa - at.kappa * x.tau) / at.tau,
        )

    def to_edges(self) -> "Directed":
        """Return the predictor, a step to the edges of all cones."""
        right = self._ahead.right
        return self._roughly(self._ahead, self._start, self._system.leaves(right, self._start))

    def to_centre(self, mu: float, share: float, ahead: "Directed") -> tuple["Directed", "Aim"]:
        """Return the corrected step towards ``s o z = mu e``, and its aim.

        The correction is the error of the predictor in its own aim.
        """
        at, step = self._place.at, ahead.step
        slacks, multipliers = step.cones
        triples = zip(self._scalings, slacks, multipliers, strict=True)
        wanted = [self._loops.corrected(scaling, ds, dz, mu) for scaling, ds, dz in triples]
        kappa = mu - at.tau * at.kappa - step.tau * step.kappa
        aim = Aim(share, tuple(wanted), kappa)
        return self.towards(aim, ahead), aim

    def towards(self, aim: "Aim", known: "Directed") -> "Directed":
        """Return the step to an aim by a single solve for the difference from a known step."""
        given = self._given(aim)
        beside = given.right.plus(known.given.right, -1.0)
        more = self._system.once(beside)
        left = known.left.plus(self._system.leaves(beside, more))
        return self._roughly(given, known.plain.plus(more), left)

    def exactly(self, known: "Directed", tolerance: float) -> Step:
        """Return a refined step.

        In the units of the scaling, the forces of stiff contact are small. Those of a few points
        that are held in all directions may remain far from balance, and are then solved for
        separately.
        """
        given, system = known.given, self._system
        right = given.right
        x = system.solve(right, known.x, EXACT, MOST)
        left = system.left(right, x)
        allowed = _BALANCED * max(_largest(right.force), tolerance * self._loads())
        for _ in range(_AGAIN):
            if _largest(left.force) <= allowed:
                break
            other = x.plus(system.solve(left, system.once(left), _MENDED, MOST))
            now = system.left(right, other)
            if not _largest(now.force) < _largest(left.force):
                break
            x, left = other, now
        return self._step(given, x)

    def _loads(self) -> float:
        """Return the sum of all nodal loads, times tau."""
        conic, at = self._place.conic, self._place.at
        loads = abs(at.load) * np.abs(conic.load).sum() + at.tau * conic.weight
        return float(loads)

    def _given(self, aim: "Aim") -> _Reduced:
        pairs = zip(self._scalings, aim.products, strict=True)
        heights = [self._loops.heights(scaling, more) for scaling, more in pairs]
        return self._reduced(aim.share, heights, aim.kappa)

    def banded(
        self, step: Step, share: float, band: tuple[float, float]
    ) -> tuple[list[Floats], float]:
        """Return the changes that bring the eigenvalues of ``s o z`` after a step into a band.

        They are those after a share of the step. The second value is the change of tau kappa, which
        is reduced by no more than the upper end of the band.
        """
        at = self._place.at
        slacks, multipliers = step.cones
        triples = zip(self._scalings, slacks, multipliers, strict=True)
        found = [self._loops.banded(own, ds, dz, share, band) for own, ds, dz in triples]
        kappa = (at.tau + share * step.tau) * (at.kappa + share * step.kappa)
        return found, max(min(max(kappa, band[0]), band[1]) - kappa, -band[1])


@dataclass(frozen=True)
class Directed:
    """Step, and the solution of the equations that it comes from.

    Attributes:
        step: the step that belongs to x.
        given: the equations.
        x: their solution, with exact rates along the flow.
        plain, left: the solution without that correction, and its residual without round-off.
    """

    step: Step
    given: _Reduced
    x: Vector
    plain: Vector
    left: Vector


@dataclass(frozen=True)
class Aim:
    """Aim of a step: share of the residuals, products, and tau kappa."""

    share: float
    products: tuple[Floats, ...]
    kappa: float

    def more(self, products: Sequence[Floats], kappa: float) -> "Aim":
        """Return the aim with other products added."""
        pairs = zip(self.products, products, strict=True)
        return Aim(self.share, tuple(a + b for a, b in pairs), self.kappa + kappa)


def _largest(force: Floats) -> float:
    return float(np.abs(force).max(initial=0.0))
