"""Newton steps of the embedding: predictor, corrector, and the correctors of Gondzio."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from backends._embedding.cones import Compliance, inner
from backends._embedding.frames import Frame
from backends._embedding.place import Place, Step, paired
from backends._embedding.system import Border, System
from backends._embedding.vectors import Vector
from lacore.arrays import Floats

EXACT, MOST = 1e-5, 5
ROUGH, FEW = 1e-3, 1
_AGAIN = 2  # times a solution is mended whose forces do not balance
_BALANCED = 0.1  # of the forces out of balance, or of the tolerance: what a step may leave


@dataclass(frozen=True)
class _Reduced:
    """Right-hand sides of a direction, its t set aside: ``dt = lead + by_tau dtau - across.dz_1``.

    Attributes:
        right: of `System`.
        leads: of the t of costly cones.
        heights: ``W^2 dz + ds`` of each cone.
        kappa: of ``tau dkappa + kappa dtau``.
    """

    right: Vector
    leads: tuple[Floats, ...]
    heights: Sequence[Floats]
    kappa: float


class Directions:
    """Steps from one place."""

    def __init__(self, place: Place, system: System) -> None:
        """Raises `SingularError` where the stiffness is not definite."""
        conic, at = place.conic, place.at
        self._place, self._system = place, system
        self._slopes: list[Floats] = []
        self._loops = conic.equal.loops
        pairs = zip(place.slacks, place.multipliers, strict=True)
        self._scalings = [self._loops.scaled(s, z) for s, z in pairs]
        self._twice = [Compliance.twice(scaling) for scaling in self._scalings]
        count = len(conic.costly)
        self._first = count + len(conic.free)  # of the cones of planes
        self._costly, self._free = self._scalings[:count], self._scalings[count : self._first]
        # Of the t: 1 + a, what tau does to it, and what stresses do.
        self._raised, self._by_tau, self._across = [], [], []
        soft: list[Compliance | Frame] = []
        rates, slopes = [], []
        slope_tau = -place.rising / at.tau**2 - at.kappa / at.tau
        for one, scaling, t in zip(conic.costly, self._costly, at.leads, strict=True):
            first, square = scaling.w[0], scaling.square
            both = square * (2 * first**2 - 1)
            raised = 1 + both * one.rise
            rise = square * one.rise
            size = inner(scaling.w[1:], scaling.w[1:])
            rank = 2 * (1 - rise) / (1 + (1 + 2 * size) * rise)
            soft.append(Compliance(square, rank, scaling.w[1:]))
            across = 2 * square * first / raised * scaling.w[1:]
            slope = one.cost + one.rise * t * (2 / at.tau)
            self._raised.append(raised)
            self._by_tau.append(-both * one.cost / raised)
            self._across.append(across)
            rates.append(one.cost * across)
            slopes.append(-slope * across)
            slope_tau += float(slope @ self._by_tau[-1])
            self._slopes.append(slope)
        soft += self._twice[count : self._first]
        rates += [kind.offset for kind in conic.free]
        slopes += [kind.offset for kind in conic.free]
        for planes, own in paired(conic.planes, self._scalings[self._first :]):
            heavy = planes.multipliers(1.0, np.zeros((planes.rows.dim, planes.rows.count)))
            heavy = [Compliance.twice(one).times(z) for one, z in zip(own, heavy, strict=True)]
            by_tau = planes.summed(heavy)
            rates.append(by_tau.copy())
            rates[-1][planes.sheared :] -= planes.given
            slopes.append(-by_tau)
            slopes[-1][planes.sheared :] -= planes.given
            slope_tau -= planes.cost(heavy)
            soft.append(Frame.of(planes, own))
        border = Border(tuple(rates), tuple(slopes), slope_tau)
        heights = [-s for s in place.slacks]
        self._ahead = self._reduced(1.0, heights, -at.tau * at.kappa)
        self._start = system.factorise(soft, self._reference(), border, self._ahead.right)

    def _reference(self) -> float:
        """A compliance per squared norm of rows, of the cones where power is dissipated.

        Across its direction a flowing cone has t/c; along it none resists.
        """
        conic, place = self._place.conic, self._place
        count = len(conic.costly)
        softness = power = 0.0
        for one, scaling, lead in zip(conic.costly, self._costly, place.at.leads, strict=True):
            share = one.cost * lead
            softness += float(np.sum(share * scaling.square / one.rows.norms))
            power += float(share.sum())
        for kind, scaling, s, z in zip(
            conic.free,
            self._free,
            place.slacks[count : self._first],
            place.multipliers[count : self._first],
            strict=True,
        ):
            if kind.pressed:
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
        """Right-hand sides of a step that takes a share of what is left.

        Args:
            share: of the residuals.
            heights: ``W^2 dz + ds`` of each cone.
            kappa: ``tau dkappa + kappa dtau``.
        """
        conic, left = self._place.conic, self._place.left
        count = len(conic.costly)
        costly, leads = [], []
        for one, height, raised, across, missed in zip(
            conic.costly, heights[:count], self._raised, self._across, left.costly, strict=True
        ):
            leads.append(height[0] / raised)
            costly.append(height[1:] - one.rise * height[0] * across - share * missed)
        free = [
            height - share * missed
            for height, missed in zip(heights[count : self._first], left.free, strict=True)
        ]
        of_planes = []
        pairs = paired(conic.planes, heights[self._first :])
        for (planes, own), missed in zip(pairs, left.planes, strict=True):
            of_planes.append(planes.summed(own) - share * missed)
        gap = -share * left.gap - kappa / self._place.at.tau
        gap -= sum(float(a @ b) for a, b in zip(self._slopes, leads, strict=True))
        gap -= sum(planes.cost(own) for planes, own in pairs)
        right = self._system.layout.zeros()
        right.force[:] = -share * left.force
        right.equal[:] = -share * left.equal
        for part, given in zip(right.parts[:-1], (*costly, *free, *of_planes), strict=True):
            part[:] = given
        right.data[-2:] = -share * left.load, gap
        return _Reduced(right, tuple(leads), heights, kappa)

    def _roughly(self, given: _Reduced, start: Vector) -> "Directed":
        """The step from such a start."""
        x = self._system.solve(given.right, start, ROUGH, FEW)
        return Directed(self._step(given, x), given, x)

    def _step(self, given: _Reduced, x: Vector) -> Step:
        """All of a step of which the solution of the equations is known."""
        conic, at = self._place.conic, self._place.at
        leads = tuple(
            lead + more * x.tau - inner(across, z)
            for lead, more, across, z in zip(
                given.leads, self._by_tau, self._across, x.costly, strict=True
            )
        )
        count = len(conic.costly)
        # Products come out as aimed at, whatever the solution leaves: rates that are missed wait
        # for the next step, where cones, whose edges are near, would end this one.
        rates = tuple(
            (height - own.times(np.vstack([one.cost * x.tau + one.rise * lead, z])))[1:]
            for one, own, height, lead, z in zip(
                conic.costly,
                self._twice[:count],
                given.heights[:count],
                leads,
                x.costly,
                strict=True,
            )
        )
        slacks = tuple(
            height - own.times(r)
            for own, height, r in zip(
                self._twice[count : self._first],
                given.heights[count : self._first],
                x.free,
                strict=True,
            )
        )
        turned = [
            part
            for planes, zeta in zip(conic.planes, x.planes, strict=True)
            for part in planes.multipliers(x.tau, zeta)
        ]
        flows = tuple(
            height - own.times(part)
            for own, height, part in zip(
                self._twice[self._first :], given.heights[self._first :], turned, strict=True
            )
        )
        return Step(
            conic=conic,
            velocity=x.force,
            leads=leads,
            rates=rates,
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
        """The predictor: to the edges of all cones."""
        return self._roughly(self._ahead, self._start)

    def to_centre(self, mu: float, share: float, ahead: "Directed") -> tuple["Directed", "Aim"]:
        """Towards ``s o z = mu e``, corrected by what the predictor leaves of its own aim."""
        at, step = self._place.at, ahead.step
        slacks, multipliers = step.cones
        triples = zip(self._scalings, slacks, multipliers, strict=True)
        wanted = [self._loops.corrected(scaling, ds, dz, mu) for scaling, ds, dz in triples]
        kappa = mu - at.tau * at.kappa - step.tau * step.kappa
        aim = Aim(share, tuple(wanted), kappa)
        return self.towards(aim, ahead), aim

    def towards(self, aim: "Aim", known: "Directed") -> "Directed":
        """The step to an aim, by a single solve of what it is beside one that is known."""
        given = self._given(aim)
        beside = given.right.plus(known.given.right, -1.0)
        return self._roughly(given, known.x.plus(self._system.once(beside)))

    def exactly(self, known: "Directed", tolerance: float) -> Step:
        """A step refined.

        In units of the scaling, forces on stiff contact are small: those of a few points that are
        held in all directions may be left far out of balance, and are asked for themselves.
        """
        given, system = known.given, self._system
        right = given.right
        x = system.solve(right, known.x, EXACT, MOST)
        left = system.left(right, x)
        allowed = _BALANCED * max(_largest(right.force), tolerance * self._loads())
        for _ in range(_AGAIN):
            if _largest(left.force) <= allowed:
                break
            other = x.plus(system.solve(left, system.once(left), EXACT, MOST))
            now = system.left(right, other)
            if not _largest(now.force) < _largest(left.force):
                break
            x, left = other, now
        return self._step(given, x)

    def _loads(self) -> float:
        """Sum of all nodal loads, times tau."""
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
        """What moves eigenvalues of ``s o z`` after a share of a step into a band.

        And tau kappa, no further down than its upper end.
        """
        at = self._place.at
        slacks, multipliers = step.cones
        triples = zip(self._scalings, slacks, multipliers, strict=True)
        found = [self._loops.banded(own, ds, dz, share, band) for own, ds, dz in triples]
        kappa = (at.tau + share * step.tau) * (at.kappa + share * step.kappa)
        return found, max(min(max(kappa, band[0]), band[1]) - kappa, -band[1])


@dataclass(frozen=True)
class Directed:
    """A step, and the solution of the equations that it is made of."""

    step: Step
    given: _Reduced
    x: Vector


@dataclass(frozen=True)
class Aim:
    """What a step is to do: with a share of the residuals, to products, and to tau kappa."""

    share: float
    products: tuple[Floats, ...]
    kappa: float

    def more(self, products: Sequence[Floats], kappa: float) -> "Aim":
        """With other products added."""
        pairs = zip(self.products, products, strict=True)
        return Aim(self.share, tuple(a + b for a, b in pairs), self.kappa + kappa)


def _largest(force: Floats) -> float:
    return float(np.abs(force).max(initial=0.0))
