"""Static program (T7) as a nonlinear program for IPOPT. Not a backend.

Maximise ``alpha - sum w shift t_n`` over the load factor, stresses, mean stresses and reactions,
subject to equilibrium, ``||s|| <= bound``, ``t_n >= 0`` and ``t_t = t_1 + t_2`` with ``||t_1|| <=
g``, ``||t_2|| <= d t_n``. Equilibrium is linear, the rest convex; the velocity is the multiplier of
equilibrium.

Stresses without effect on any velocity (pressure modes of crossed meshes, shear under stick) make
Newton's matrix singular, which MUMPS does not always detect. The Hessian gives mean stresses and
frictions a small curvature that is not in the gradients: the steps change, the solution does not.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
from scipy.sparse import csr_matrix, diags_array, hstack, vstack

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces
from lacore_backends._ipopt import to_casadi

LARGEST = 1e6  # limit of the dimensionless load factor, which no structure reaches
_DAMPING = 1e-6  # curvature per weight: with 1e-5 graded meshes need half as many steps again
# At the apex of cones a monotone barrier stalls, and a filter rejects the steps that lead away from
# there.
_FREE = {"mu_strategy": "adaptive", "adaptive_mu_globalization": "never-monotone-mode"}


@dataclass(frozen=True)
class StaticResult:
    """Result of one run of IPOPT: unknowns, and multipliers of all rows."""

    native: str
    iterations: int
    x: Floats
    multipliers: Floats


@dataclass(frozen=True)
class _Law:
    """Convex function of the unknowns of one point: value and gradient, multiplied Hessian."""

    slope: Any
    curvature: Any


@dataclass(frozen=True)
class _Cones:
    """Convex inequalities ``law(x[columns]) <= upper`` with `dim` unknowns per point."""

    law: _Law
    columns: Ints
    dim: int
    constants: Floats

    @property
    def count(self) -> int:
        return self.columns.size // self.dim

    def rows(self, x: Any, multipliers: Any) -> tuple[Any, Any, Any]:
        """Return values, Jacobian, and Hessian of ``multipliers . law``."""
        own = np.arange(self.columns.size)
        entries = (np.ones(own.size), (own, self.columns))
        pick = to_casadi(csr_matrix(entries, (own.size, x.shape[0])))
        local = ca.reshape(ca.mtimes(pick, x), self.dim, self.count)
        constants = ca.DM(self.constants).T
        value, slope = self.law.slope.map(self.count)(local, constants)
        curvature = self.law.curvature.map(self.count)(local, constants, multipliers.T)
        wide = ca.diagcat(*[ca.Sparsity.dense(1, self.dim)] * self.count)
        blocks = ca.diagcat(*[ca.Sparsity.dense(self.dim, self.dim)] * self.count)
        return (
            value.T,
            ca.mtimes(ca.MX(wide, ca.vec(slope)), pick),
            ca.mtimes(pick.T, ca.mtimes(ca.MX(blocks, ca.vec(curvature)), pick)),
        )


class StaticProgram:
    """Static program for given dilatancies; bounds and shifts are given for each run.

    Unknowns x: load factor, share of the dead load; for each group stresses divided by their bound
    and mean stresses; t_n, t_1, and t_2 of the dilatant points.
    """

    def __init__(self, program: KinematicProgram, dilatancy: Floats) -> None:
        self._program = program
        points, dim = program.contact, program.contact.tangent_dim
        self._dilatant = dilatancy > 0
        d = dilatancy[self._dilatant]
        forces, damped = self._unknowns()
        ends = np.cumsum([0, *(block.shape[1] for block in forces)])
        parts = [np.arange(a, b) for a, b in pairwise(ends)]
        contacts = 2 + 2 * len(program.groups)
        self._stresses, self._means = parts[2:contacts:2], parts[3:contacts:2]
        self._normal, self._friction, self._dilated = parts[contacts : contacts + 3]
        self._left = parts[contacts + 3 :]
        self._damped = _DAMPING * np.concatenate(damped)

        linear = [csr_matrix(hstack(forces, format="csr"))]
        lifted = self._normal[self._dilatant]
        if dim == 1:  # d t_n +- t_2 >= 0
            linear += [
                _combined(lifted, d, self._dilated, sign, int(ends[-1])) for sign in (1.0, -1.0)
            ]
        self._unequal = sum(block.shape[0] for block in linear) - program.n
        own = [
            (group.surfaces, means)
            for group, means in zip(program.groups, self._means, strict=True)
            if group.surfaces is not None
        ]
        linear += [
            _remaining(surfaces, left, means, int(ends[-1]))
            for (surfaces, means), left in zip(own, self._left, strict=True)
        ]
        self._strengths = np.concatenate([np.zeros(0), *(s.strength.ravel() for s, _ in own)])
        self._linear = csr_matrix(vstack(linear, format="csr"))
        self._balls = self._strengths_of_groups()
        self._discs, self._fans = [], self._planes()
        if dim > 1:
            both = np.column_stack([lifted, self._dilated.reshape(-1, dim)])
            self._discs = [_Cones(_square(dim), self._friction, dim, np.ones(points.count))]
            self._fans += [_Cones(_fan(1 + dim), both.ravel(), 1 + dim, d)]
        self._problem, self._derivatives = self._functions()

    def _unknowns(self) -> tuple[list[Sparse], list[Floats]]:
        """Return nodal forces and damping of the unknowns of each kind, in their order."""
        program, points = self._program, self._program.contact
        turning = np.repeat(self._dilatant, points.tangent_dim)
        weights = np.repeat(points.weights, points.tangent_dim)
        loads = [csr_matrix(-f[:, None]) for f in (program.reference_load, program.dead_load)]
        forces, damped = loads, [np.zeros(2)]
        for group in program.groups:
            unit = group.bound if group.surfaces is None else np.ones(group.weights.size)
            size = np.repeat(group.weights * unit, group.dim)
            volumes = group.volume_weights
            forces += [_forces(group.rows, size), _forces(group.volumetric, volumes)]
            damped += [np.zeros(size.size), volumes]
        slip = _forces(points.tangential, -weights)
        forces += [_forces(points.normal, -points.weights), slip, slip[:, turning]]
        damped += [np.zeros(points.count), weights, weights[turning]]
        # The margin of strength of surfaces is an unknown on which no force acts.
        pressure_dependent = [
            group.surfaces for group in program.groups if group.surfaces is not None
        ]
        forces += [csr_matrix((program.n, own.strength.size)) for own in pressure_dependent]
        damped += [np.zeros(own.strength.size) for own in pressure_dependent]
        return forces, damped

    def _strengths_of_groups(self) -> list[_Cones]:
        """Return ``||s|| <= 1`` of stresses over their bound, of groups without surfaces."""
        return [
            _Cones(_square(group.dim), columns, group.dim, np.ones(group.weights.size))
            for group, columns in zip(self._program.groups, self._stresses, strict=True)
            if group.dim > 1 and group.surfaces is None
        ]

    def _planes(self) -> list[_Cones]:
        """Return the cones that limit ``||s||`` to the margin of each surface."""
        pressure_dependent = [
            (group, columns)
            for group, columns in zip(self._program.groups, self._stresses, strict=True)
            if group.surfaces is not None
        ]
        found = []
        for (group, columns), left in zip(pressure_dependent, self._left, strict=True):
            assert group.surfaces is not None
            shear = columns.reshape(-1, group.dim)
            for lead in left.reshape(-1, group.surfaces.count).T[group.surfaces.normed > 0]:
                both = np.column_stack([lead, shear]).ravel()
                found.append(_Cones(_fan(1 + group.dim), both, 1 + group.dim, np.ones(lead.size)))
        return found

    def _functions(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the problem and its derivatives for `casadi.nlpsol`."""
        x, cost = (ca.MX.sym(name, self._linear.shape[1]) for name in ("x", "cost"))
        linear = to_casadi(self._linear)
        cones = [part for part in (*self._balls, *self._discs, *self._fans) if part.count]
        factor = ca.MX.sym("lam_f")
        multipliers = ca.MX.sym("lam_g", linear.shape[0] + sum(part.count for part in cones))
        values, slopes = [ca.mtimes(linear, x)], [linear]
        curvature, first = ca.diag(ca.DM(self._damped)), linear.shape[0]
        for part in cones:
            value, slope, more = part.rows(x, multipliers[first : first + part.count])
            values.append(value)
            slopes.append(slope)
            curvature, first = curvature + more, first + part.count
        # They are dense because an unknown without any force leaves an empty row.
        power, rows = ca.dot(cost, x), ca.densify(ca.vertcat(*values))
        return {"x": x, "p": cost, "f": power, "g": rows}, {
            "grad_f": ca.Function("grad_f", [x, cost], [power, cost]),
            "jac_g": ca.Function("jac_g", [x, cost], [rows, ca.vertcat(*slopes)]),
            "hess_lag": ca.Function(
                "hess_lag", [x, cost, factor, multipliers], [ca.triu(curvature)]
            ),
        }

    def run(
        self,
        contact: FrozenContact,
        tolerance: float,
        max_iterations: int,
        time_limit: float,
        share: bool = False,
    ) -> StaticResult:
        """Solve from the smallest stresses that balance the dead load.

        Args:
            contact: contact with the dilatancies of this program.
            tolerance, max_iterations, time_limit: IPOPT's.
            share: maximise the share of the dead load that can be carried, up to 1, instead.
        """
        points = self._program.contact
        dim = points.tangent_dim
        options: dict[str, Any] = {
            "print_time": False,
            "error_on_fail": False,
            "calc_lam_p": False,
            "ipopt": {
                "print_level": 0,
                "sb": "yes",
                "tol": tolerance,
                # It ends close to the central path, at mu = tolerance/10: reactions that no law
                # determines are then the same in each solve, as the reaction loop requires.
                "barrier_tol_factor": 1.0,
                "compl_inf_tol": tolerance / 5,
                "max_iter": max_iterations,
                "max_wall_time": time_limit,
                "acceptable_iter": 0,
                "bound_relax_factor": 0.0,  # The default moves every bound by 1e-8.
                "nlp_scaling_method": "none",
                # MUMPS scales and permutes the rows without curvature into fill, which takes up to
                # 11 times longer on medium meshes and is no more accurate.
                "mumps_permuting_scaling": 0,
                "mumps_scaling": 0,
                "jac_c_constant": "yes",
                "grad_f_constant": "yes",
                # Start from stresses that balance the dead load; if there are none, this is
                # detected early.
                "least_square_init_primal": "yes",
                "expect_infeasible_problem": "yes",
            },
        }
        if self._program.pressure_dependent:
            options["ipopt"].update(_FREE)
        nlp = ca.nlpsol("static", "ipopt", self._problem, {**self._derivatives, **options})
        cost = np.zeros(self._linear.shape[1])
        cost[1 if share else 0] = -1.0
        cost[self._normal] = points.weights * contact.shift
        for group, means in zip(self._program.groups, self._means, strict=True):
            if group.surfaces is not None and not share:
                cost[means] = group.volume_weights * group.surfaces.besides
        low, high = np.full(cost.size, -np.inf), np.full(cost.size, np.inf)
        low[1], high[1] = 0.0 if share else 1.0, 1.0
        high[0] = np.inf if share else LARGEST
        low[self._normal] = 0.0
        for left in self._left:
            low[left] = 0.0
        for group, columns in zip(self._program.groups, self._stresses, strict=True):
            if group.dim == 1 and group.surfaces is None:
                low[columns], high[columns] = -1.0, 1.0
        bound = np.repeat(contact.bound, dim)
        high[self._friction] = bound if dim == 1 else np.where(bound > 0, np.inf, 0.0)
        low[self._friction] = -high[self._friction]
        equal = self._program.n
        upper = np.full(self._problem["g"].shape[0], np.inf)
        upper[:equal] = 0.0
        first = self._linear.shape[0]
        leaving = slice(equal + self._unequal, first)
        upper[leaving] = self._strengths
        for part in self._balls:
            upper[first : first + part.count] = 1.0
            first += part.count
        # Without friction the unknowns are fixed, and the rows are inactive.
        for part in self._discs:
            upper[first : first + part.count] = np.where(contact.bound > 0, contact.bound**2, 1.0)
            first += part.count
        upper[first:] = 0.0
        lower = np.zeros(upper.size)
        lower[leaving] = self._strengths
        lower[self._linear.shape[0] :] = -np.inf
        start = np.zeros(cost.size)
        start[1], start[self._normal] = 1.0, 1.0
        for left in self._left:
            start[left] = 1.0
        answer = nlp(x0=start, p=cost, lbx=low, ubx=high, lbg=lower, ubg=upper)
        stats = nlp.stats()
        return StaticResult(
            native=str(stats["return_status"]),
            iterations=int(stats["iter_count"]),
            x=np.array(answer["x"]).ravel(),
            multipliers=np.array(answer["lam_g"]).ravel(),
        )

    def velocity(self, found: StaticResult) -> Floats:
        """Return the multipliers of equilibrium, with F0.U = 1 at a solution."""
        return -found.multipliers[: self._program.n]

    def state(self, found: StaticResult) -> ProgramState:
        """Return velocity and stresses with the signs of `ProgramState`."""
        program, x = self._program, found.x
        tangential = x[self._friction].reshape(-1, program.contact.tangent_dim)
        dilated = x[self._dilated].reshape(-1, program.contact.tangent_dim)
        tangential[self._dilatant] += dilated
        velocity = self.velocity(found)
        power = float(program.reference_load @ velocity)
        return ProgramState(
            velocity=velocity / (power if power > 0 else 1.0),
            load_factor=float(x[0]),
            stress=tuple(
                x[columns].reshape(-1, group.dim)
                * (group.bound[:, None] if group.surfaces is None else 1.0)
                for group, columns in zip(program.groups, self._stresses, strict=True)
            ),
            mean_stress=tuple(x[columns] for columns in self._means),
            normal_reaction=x[self._normal],
            tangential_reaction=tangential,
        )


def _forces(rows: Sparse, weights: Floats) -> Sparse:
    """Return the nodal forces of unit stresses, one per column."""
    return csr_matrix(rows.T @ diags_array(weights))


def _combined(lifted: Ints, d: Floats, dilated: Ints, sign: float, size: int) -> Sparse:
    """Return the rows ``d x[lifted] + sign x[dilated]``."""
    own = np.arange(d.size)
    entries = np.concatenate([d, np.full(d.size, sign)])
    where = (np.concatenate([own, own]), np.concatenate([lifted, dilated]))
    return csr_matrix((entries, where), (d.size, size))


def _remaining(surfaces: Surfaces, left: Ints, means: Ints, size: int) -> Sparse:
    """Return the rows ``left + slope . p`` of each surface, which equal the strengths."""
    m, k, volumes = surfaces.slope.shape
    own = np.arange(m * k)
    slopes = surfaces.slope.reshape(m * k, volumes)
    mean_stresses = means.reshape(m, volumes)[own // k]
    entries = np.concatenate([np.ones(own.size), slopes.ravel()])
    where = (
        np.concatenate([own, np.repeat(own, volumes)]),
        np.concatenate([left, mean_stresses.ravel()]),
    )
    return csr_matrix((entries, where), (own.size, size))


def _law(value: Any, local: Any, constant: Any) -> _Law:
    multiplier = ca.SX.sym("m")
    curvature, slope = ca.hessian(value, local)
    return _Law(
        ca.Function("slope", [local, constant], [value, slope]),
        ca.Function(
            "curvature", [local, constant, multiplier], [ca.densify(multiplier * curvature)]
        ),
    )


def _square(dim: int) -> _Law:
    """Return the law ``||v||^2``."""
    v = ca.SX.sym("v", dim)
    return _law(ca.dot(v, v), v, ca.SX.sym("c"))


def _fan(dim: int) -> _Law:
    """Return ``||t||^2/(d t_n) - d t_n`` of (t_n, t), convex for t_n > 0, which is its bound."""
    v, d = ca.SX.sym("v", dim), ca.SX.sym("d")
    return _law(ca.dot(v[1:], v[1:]) / (d * v[0]) - d * v[0], v, d)
