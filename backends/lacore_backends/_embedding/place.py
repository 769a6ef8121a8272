"""Iterates of the homogeneous self-dual embedding and their residuals."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_backends._embedding.arrays import Conic, Multipliers
from lacore_backends._embedding.cones import inner, inside, lengths
from lacore_backends._embedding.pressure_dependent import Planes

T = TypeVar("T")


@dataclass(frozen=True)
class Step:
    """Iterate or a change of one.

    Attributes:
        conic: the program.
        velocity: u, shape (n,).
        strained: t and y of costly cones, shape (1 + d, m) each.
        stresses: z_1 of costly cones, shape (d, m) each.
        equal: p.
        slacks, pressures: x and r of free cones, shape (dim, m) each.
        flows: x of the cones of planes, two arrays for each of their kinds.
        bounded: zeta of planes, shape (d + L, m) each.
        load: lambda.
        tau, kappa: variables of the embedding.
    """

    conic: Conic
    velocity: Floats
    strained: tuple[Floats, ...]
    stresses: tuple[Floats, ...]
    equal: Floats
    slacks: tuple[Floats, ...]
    pressures: tuple[Floats, ...]
    flows: tuple[Floats, ...]
    bounded: tuple[Floats, ...]
    load: float
    tau: float
    kappa: float

    def plus(self, other: "Step", share: float = 1.0) -> "Step":
        """Return the sum with a share of the other step."""

        def sums(own: Iterable[Floats], more: Iterable[Floats]) -> tuple[Floats, ...]:
            return tuple(a + share * b for a, b in zip(own, more, strict=True))

        return Step(
            self.conic,
            self.velocity + share * other.velocity,
            sums(self.strained, other.strained),
            sums(self.stresses, other.stresses),
            self.equal + share * other.equal,
            sums(self.slacks, other.slacks),
            sums(self.pressures, other.pressures),
            sums(self.flows, other.flows),
            sums(self.bounded, other.bounded),
            self.load + share * other.load,
            self.tau + share * other.tau,
            self.kappa + share * other.kappa,
        )

    @cached_property
    def cones(self) -> tuple[list[Floats], list[Floats]]:
        """Slacks and multipliers of all cones, costly ones first, each of shape (1 + d, m).

        Of costly cones ``z_0 = c tau + h t`` holds whatever the step is, and ``z_i = c_i tau + B_i
        zeta`` of planes.
        """
        multipliers = []
        for one, own, stress in zip(self.conic.costly, self.strained, self.stresses, strict=True):
            both = np.empty_like(own)
            both[0] = one.cost * self.tau + one.rise * own[0]
            both[1:] = stress
            multipliers.append(both)
        of_planes = [
            part
            for one, bounded in zip(self.conic.planes, self.bounded, strict=True)
            for part in one.multipliers(self.tau, bounded)
        ]
        return (
            [*self.strained, *self.slacks, *self.flows],
            [*multipliers, *self.pressures, *of_planes],
        )

    @property
    def flowing(self) -> list[tuple[Planes, Sequence[Floats]]]:
        """Planes of each kind, and their flows."""
        return paired(self.conic.planes, self.flows)


def paired(planes: Sequence[Planes], parts: Sequence[T]) -> list[tuple[Planes, Sequence[T]]]:
    """Return the planes of each kind with the parts of both of their kinds of cones."""
    return [(one, parts[2 * at : 2 * at + 2]) for at, one in enumerate(planes)]


@dataclass(frozen=True)
class Left:
    """Residuals of an iterate in the equations of the embedding.

    Attributes:
        force: residual of equilibrium, shape (n,).
        equal: ``E u``.
        costly, free: ``D u - y`` and ``G u + g tau - x``.
        planes: ``R u - e tau - sum B_i^T x_i``.
        load: ``F0.u - tau``.
        gap: ``kappa + c.t - Fd.u - ...``.
    """

    force: Floats
    equal: Floats
    costly: tuple[Floats, ...]
    free: tuple[Floats, ...]
    planes: tuple[Floats, ...]
    load: float
    gap: float


class Place:
    """Iterate with cached results."""

    def __init__(self, conic: Conic, at: Step) -> None:
        self.conic, self.at = conic, at
        self.slacks, self.multipliers = at.cones

    @property
    def sound(self) -> bool:
        """Whether the iterate is strictly inside all cones."""
        return (
            self.at.tau > 0
            and self.at.kappa > 0
            and all(inside(part) for part in (*self.slacks, *self.multipliers))
        )

    @cached_property
    def powers(self) -> list[Floats]:
        """``s.z`` of each cone."""
        return [inner(s, z) for s, z in zip(self.slacks, self.multipliers, strict=True)]

    @cached_property
    def mu(self) -> float:
        """Mean of ``s.z`` and ``tau kappa``."""
        total = sum(float(power.sum()) for power in self.powers) + self.at.tau * self.at.kappa
        return total / (self.conic.degree + 1)

    @cached_property
    def rising(self) -> float:
        """``sum h t^2``."""
        pairs = zip(self.conic.costly, self.at.strained, strict=True)
        return sum(float(one.rise @ (own[0] * own[0])) for one, own in pairs)

    @cached_property
    def cost(self) -> float:
        """Primal objective times tau: ``c.t + h t^2/(2 tau) - Fd.u``."""
        pairs = zip(self.conic.costly, self.at.strained, strict=True)
        plastic = sum(float(one.cost @ own[0]) for one, own in pairs)
        plastic += sum(one.cost(flows) for one, flows in self.at.flowing)
        return plastic + self.rising / (2 * self.at.tau) - float(self.conic.dead @ self.at.velocity)

    @property
    def dissipating(self) -> float:
        """As `cost`, but with the strain rates of the velocity in place of the rates of cones.

        Planes keep the cost of their flows, because many flows have the same strain rate.
        """
        conic, u = self.conic, self.at.velocity
        plastic = sum(float(one.cost @ lengths(one.rows.at(u))) for one in conic.costly)
        plastic += sum(one.cost(flows) for one, flows in self.at.flowing)
        return plastic - float(conic.dead @ u)

    @cached_property
    def bound(self) -> float:
        """Dual objective times tau: ``lambda - g.r + e.zeta - h t^2/(2 tau)``."""
        conic, at = self.conic, self.at
        shifted = sum(
            float(np.sum(kind.offset * r)) for kind, r in zip(conic.free, at.pressures, strict=True)
        )
        for one, zeta in zip(conic.planes, at.bounded, strict=True):
            shifted -= float(np.sum(one.given * zeta[one.sheared :]))
        return at.load - shifted - self.rising / (2 * at.tau)

    @cached_property
    def force(self) -> Floats:
        """Nodal forces of all multipliers except those of the loads, shape (n,)."""
        conic, at = self.conic, self.at
        force = conic.equal.force(at.equal[None])
        for one, z in zip(conic.costly, at.stresses, strict=True):
            force = force + one.rows.force(z)
        for kind, r in zip(conic.free, at.pressures, strict=True):
            force = force + kind.rows.force(r)
        for planes, zeta in zip(conic.planes, at.bounded, strict=True):
            force = force + planes.rows.force(zeta)
        return np.asarray(force)

    @cached_property
    def left(self) -> Left:
        """Residuals of all equations."""
        conic, at = self.conic, self.at
        return Left(
            self.force + at.load * conic.load + at.tau * conic.dead,
            conic.equal.at(at.velocity)[0],
            tuple(
                one.rows.at(at.velocity) - own[1:]
                for one, own in zip(conic.costly, at.strained, strict=True)
            ),
            tuple(
                kind.rows.at(at.velocity) + at.tau * kind.offset - x
                for kind, x in zip(conic.free, at.slacks, strict=True)
            ),
            tuple(one.missed(at.velocity, at.tau, flows) for one, flows in at.flowing),
            float(conic.load @ at.velocity) - at.tau,
            at.kappa + self.cost - self.bound,
        )

    @cached_property
    def missed(self) -> float:
        """Largest residual of rates and slacks, by the norm of the row."""
        conic, left = self.conic, self.left
        sizes = [np.abs(left.equal) / np.sqrt(conic.equal.norms)]
        sizes += [
            (np.abs(part) / np.sqrt(rows.norms)).ravel()
            for rows, part in zip(
                conic.kinds[:-1], (*left.costly, *left.free, *left.planes), strict=True
            )
        ]
        return largest(*(part.max(initial=0.0) for part in sizes))

    @cached_property
    def unbalanced(self) -> float:
        """Largest unbalanced nodal force."""
        return float(np.abs(self.left.force).max(initial=0.0))

    @cached_property
    def fastest(self) -> float:
        """Largest velocity."""
        return float(np.abs(self.at.velocity).max(initial=0.0))

    @cached_property
    def lost(self) -> float:
        """Power of the forces out of balance, all of one sign."""
        return float(np.abs(self.left.force) @ np.abs(self.at.velocity))

    def farthest(self, step: Step) -> float:
        """Return the largest share of a step that stays inside all cones."""
        at = self.at
        slacks, multipliers = step.cones
        shares = [
            self.conic.equal.loops.farthest(x, change)
            for x, change in zip(
                [*self.slacks, *self.multipliers], [*slacks, *multipliers], strict=True
            )
        ]
        shares += [
            -now / change if change < 0 else np.inf
            for now, change in ((at.tau, step.tau), (at.kappa, step.kappa))
        ]
        return min(shares)

    @property
    def solution(self) -> tuple[Floats, Multipliers]:
        """Velocity and multipliers of the program."""
        at = self.at
        return at.velocity / at.tau, Multipliers(
            tuple(z / at.tau for z in at.stresses),
            tuple(r / at.tau for r in at.pressures),
            tuple(zeta / at.tau for zeta in at.bounded),
            at.equal / at.tau,
            at.load / at.tau,
        )


def largest(*sizes: float) -> float:
    """Return the largest size; NaN if one of them is NaN, which the built-in max may drop."""
    return float(np.max(sizes))
