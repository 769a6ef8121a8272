"""What the benchmarks measure, and the unit that they measure in.

Times are processor times on one thread: what else runs on the machine then moves them little. The
unit is one elastic solve, analysis + factorisation + solution of the linear-elastic stiffness of
the same mesh (T36), which is measured beside each solve; ratios travel better than seconds.
"""

import time
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_matrix
from skfem import Basis
from skfem.models.elasticity import lame_parameters, linear_elasticity

import lacore as la
from lacore.numerics.linear_algebra import SuperLU
from lacore.numerics.symmetric import fast_solver, symmetric_solver
from lacore.program.kinematic import dimensionless, reaction_contact
from lacore.solvers.backend import Backend, PreparedSolver

POISSON = 0.3
_REPEATS, _ENOUGH = 3, 0.5  # elastic solves on each side of a solve, at least; s that will do


@dataclass(frozen=True)
class Model:
    """A problem without friction, ready for backends."""

    problem: la.Problem

    @cached_property
    def discretisation(self):
        return la.discretise(self.problem)

    @cached_property
    def program(self):
        return dimensionless(self.discretisation.program, self.discretisation.natural)

    @cached_property
    def contact(self):
        rows = self.program.contact
        return reaction_contact(rows, np.zeros(rows.count))

    @cached_property
    def stiffness(self):
        return stiffness(self.discretisation)

    @property
    def size(self):
        """Columns of the record."""
        bodies = self.problem.bodies.values()
        return {
            "triangles": sum(body.mesh.nelements for body in bodies),
            "unknowns": self.discretisation.program.n,
        }


def punch(nx, ny):
    """A smooth Prandtl punch on 4 nx ny triangles, crossed and graded towards its edge."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), nx, ny, grade_x=(1.0, 12.0), grade_y=(0.0, 24.0))
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("soil", "left", components="x"),
        ],
        reference_loads=[
            la.RigidFooting("soil", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), rough=False)
        ],
    )


def stiffness(discretisation):
    """Linear-elastic stiffness of all bodies for the free unknowns, (n, n), indices sorted.

    They rest on what they touch: its rows of contact are springs.
    """
    form = linear_elasticity(*lame_parameters(1.0, POISSON))
    bodies = discretisation.continua.values()
    blocks = [form.assemble(Basis(b.body.mesh, b.basis.elem, intorder=2)) for b in bodies]
    basis = discretisation.free_basis
    footings = basis.shape[0] - sum(block.shape[0] for block in blocks)
    full = block_diag([*blocks, csr_matrix((footings, footings))], format="csr")
    opening = discretisation.program.contact.normal
    matrix = csr_matrix(basis.T @ full @ basis + opening.T @ opening)
    matrix.sort_indices()
    return matrix


def direct_solvers():
    """Those that are installed."""
    return [solver for solver in (SuperLU, fast_solver()) if solver is not None]


def solve_elastic(solver, matrix, load):
    """One elastic solve."""
    solver.factorise(matrix)
    displacement = solver.solve(load)
    solver.close()
    return displacement


def elastic_seconds(model, make=symmetric_solver):
    """Shortest of several elastic solves; nothing is shared between them."""
    seconds = []
    while len(seconds) < _REPEATS or sum(seconds) < _ENOUGH:
        solver = make()
        begin = time.process_time()
        solve_elastic(solver, model.stiffness, model.program.reference_load)
        seconds.append(time.process_time() - begin)
    return min(seconds)


def dear(runs, some):
    """Parameters, some of which only `make bench-all` takes."""
    return [pytest.param(run, marks=pytest.mark.dear) if run in some else run for run in runs]


@dataclass(frozen=True)
class Clocked:
    """A backend whose `solve_time` is its processor time, that of `prepare` in the first one."""

    backend: Backend

    def prepare(self, program, options):
        begin = time.process_time()
        solver = self.backend.prepare(program, options)
        return _ClockedSolver(solver, time.process_time() - begin)


@dataclass
class _ClockedSolver:
    solver: PreparedSolver
    unreported: float

    def solve(self, contact):
        begin = time.process_time()
        answer = self.solver.solve(contact)
        spent = self.unreported + time.process_time() - begin
        self.unreported = 0.0
        return replace(answer, solve_time=spent)

    def close(self):
        self.solver.close()
