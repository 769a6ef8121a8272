"""Kinematic program as a linear program (T7), if all cones have one row. Not a backend.

Each |v| with a cost or a friction bound is split, ``v = p - q`` with p, q >= 0, so that the row
dual of the split is the stress or the tangential reaction itself. A dilatant point without a bound
is two half-spaces instead, without columns of its own. Rows are multiplied by their integration
weight as in (T34).

minimise   bound.(p + q) - Fd.U
subject to F0.U = 1              dual: load factor
           w theta U = 0         dual: -mean stress
           w D U - p + q = 0     dual: -stress; of contact points, w T U: tangential reaction
           w N U - d (p + q) >= -w s            dual: normal reaction
           w (N - d T) U >= -w s, w (N + d T) U >= -w s     duals: t_n is their sum

Sticking is p = q = 0. A change of bounds, sticking and shifts leaves the rows as they are.
"""

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array, hstack, vstack

from lacore.numerics.arrays import Floats
from lacore.program import POWER, FrozenContact, KinematicProgram
from lacore.program.state import ProgramState


class LinearForm:
    """Columns (U, p, q), p and q of all cones and then of the split contact points; rows as above.

    Attributes:
        split: whether contact points have p and q, shape (m,); the others are two half-spaces.
        dilatancy: dilatancy of the points, shape (m,).
    """

    def __init__(self, program: KinematicProgram, contact: FrozenContact) -> None:
        self._program = program
        self.dilatancy = contact.dilatancy.copy()
        # Caps that change do not change the rows of a point without dilatancy.
        self.split = (contact.dilatancy == 0) | (contact.bound > 0)
        self._cones = sum(group.weights.size for group in program.groups)
        self._points = int(self.split.sum())
        self.columns = program.n + 2 * (self._cones + self._points)
        self.rows = 1 + 2 * self._cones + 2 * program.contact.count

    def matrix(self) -> Any:
        """Return the rows, stored by columns."""
        program, contact, split = self._program, self._program.contact, self.split
        groups = [group for group in program.groups if group.weights.size]
        blocks: list[Any] = [csr_array(program.reference_load[None, :])]
        blocks += [diags_array(group.weights) @ group.volumetric for group in groups]
        blocks += [diags_array(group.weights) @ group.rows for group in groups]
        weights = diags_array(contact.weights)
        normal, slip = csr_array(weights @ contact.normal), csr_array(weights @ contact.tangential)
        dilated = diags_array(self.dilatancy[~split]) @ slip[~split]
        blocks += [slip[split], normal[split], normal[~split] - dilated, normal[~split] + dilated]
        width = self._cones + self._points
        first, points = 1 + self._cones, np.arange(self._points)
        at = (
            np.concatenate([first + np.arange(width), first + width + points]),
            np.concatenate([np.arange(width), self._cones + points]),
        )
        p, q = (
            coo_array(
                (np.concatenate([np.full(width, sign), -self.dilatancy[split]]), at),
                shape=(self.rows, width),
            )
            for sign in (-1.0, 1.0)
        )
        matrix = csc_array(hstack([vstack(blocks), p, q]))
        matrix.eliminate_zeros()
        return matrix

    def cost(self, contact: FrozenContact) -> Floats:
        """Return the dead load, stress bounds, and friction bounds; zero for points that stick."""
        bounds = [group.bound for group in self._program.groups]
        friction = np.where(np.isinf(contact.bound), 0.0, contact.bound)[self.split]
        return np.concatenate([-self._program.dead_load, *bounds, friction, *bounds, friction])

    def column_bounds(self, contact: FrozenContact) -> tuple[Floats, Floats]:
        """Return the bounds: U is free; p and q are not negative, and zero where a point sticks."""
        free = np.full(self._program.n, np.inf)
        slip = np.where(np.isinf(contact.bound), 0.0, np.inf)[self.split]
        split = np.concatenate([np.full(self._cones, np.inf), slip])
        lower = np.concatenate([-free, np.zeros(2 * split.size)])
        return lower, np.concatenate([free, split, split])

    def row_bounds(self, contact: FrozenContact) -> tuple[Floats, Floats]:
        """Return the bounds of equalities, then of openings."""
        shift = -self._program.contact.weights * contact.shift
        opening = np.concatenate([shift[self.split], shift[~self.split], shift[~self.split]])
        equal = np.zeros(self.rows - opening.size)
        equal[0] = POWER
        upper = np.full(opening.size, np.inf)
        return np.concatenate([equal, opening]), np.concatenate([equal, upper])

    def point(self, x: Floats, y: Floats) -> ProgramState:
        """Return velocity and duals with the signs of `ProgramState`."""
        program, split = self._program, self.split
        sizes = [group.weights.size for group in program.groups]
        ends = np.cumsum([1, *sizes, *sizes, self._points, self._points, split.size - self._points])
        alpha, *body, slip, opening, below, above = np.split(y, ends)
        mean, stress = body[: len(sizes)], body[len(sizes) :]
        normal, tangential = np.zeros(split.size), np.zeros(split.size)
        normal[split], tangential[split] = opening, slip
        normal[~split] = below + above
        tangential[~split] = self.dilatancy[~split] * (above - below)
        return ProgramState(
            velocity=x[: program.n],
            load_factor=float(alpha[0]),
            stress=tuple(
                -part.reshape(-1, group.dim)
                for part, group in zip(stress, program.groups, strict=True)
            ),
            mean_stress=tuple(-part for part in mean),
            normal_reaction=normal,
            tangential_reaction=tangential.reshape(-1, program.contact.tangent_dim),
        )
