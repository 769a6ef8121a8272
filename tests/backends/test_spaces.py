"""Every velocity space through every backend that takes its cones."""

import numpy as np
import pytest
from skfem.mesh import MeshQuad1

import lacore as la
from lacore.model.bodies.continuum.spaces import SPACES
from lacore.program.kinematic import dimensionless, reaction_contact
from lacore.solvers.backend import find_backend
from tests.lacore.models import CRITERION, obstacle
from tests.shares import one_in

KINEMATICS = ["plane_strain", "plane_stress"]


def heavy_block(space, kinematics):
    """Pressed and pushed on a frictional floor, held in part: all kinds of rows."""
    quads = SPACES[space].mesh is MeshQuad1
    make = la.meshes.quadrilaterals if quads else la.meshes.rectangle
    mesh = make((0, 2), (0, 1), 3, 2, grade_x=(0.0, 2.0))
    return la.Problem(
        {"block": la.Body(mesh, CRITERION, space=space, kinematics=kinematics)},
        [la.Traction("block", "left", (1, 0.2))],
        supports=[la.Fix("block", "right", "x")],
        interfaces=[obstacle(friction=0.4)],
        dead_loads=[la.Pressure("block", "top", 0.7), la.BodyForce("block", (0.05, -0.3))],
    )


@pytest.mark.parametrize("kinematics", one_in(2, KINEMATICS))
@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("other", ["cvxpy", "ipopt-static"])
def test_exact_backends_agree(space, kinematics, other):
    """After the loop too; both stop at 1e-8."""
    pytest.importorskip({"cvxpy": "cvxpy", "ipopt-static": "casadi"}[other])
    problem = heavy_block(space, kinematics)
    one, two = (la.solve(problem, name, "associated", throw=True) for name in ("clarabel", other))
    assert two.load_factor == pytest.approx(one.load_factor, rel=1e-6)
    assert two.certificate.holds(1e-6)


@pytest.mark.parametrize("kinematics", one_in(2, KINEMATICS))
@pytest.mark.parametrize("space", SPACES)
def test_regularised_backends_agree(space, kinematics):
    """One program, three methods; P <= alpha_reg <= lambda <= the exact value (T19)."""
    d = la.discretise(heavy_block(space, kinematics))
    program = dimensionless(d.program, d.natural)
    contact = reaction_contact(program.contact, np.full(program.contact.count, 0.5))

    def solved(name, **options):
        backend = find_backend(name)
        solver = backend.prepare(program, backend.Options(**options))
        try:
            return solver.solve(contact)
        finally:
            solver.close()

    exact = solved("clarabel").point.load_factor
    values = [solved(name, r=1e-3).regularised for name in ("clarabel-regularised", "newton")]
    for found in values:
        assert found.load_factor == pytest.approx(values[0].load_factor, rel=1e-6)
        assert found.alpha_reg == pytest.approx(values[0].alpha_reg, rel=1e-6)
        slack = 1e-7 * exact  # of the solvers
        assert found.plastic <= found.alpha_reg + slack <= found.load_factor + 2 * slack
        assert found.load_factor <= exact + slack
    assert values[0].load_factor == pytest.approx(exact, rel=0.02)


@pytest.mark.parametrize("backend", ["newton", "clarabel-regularised", "ipopt"])
@pytest.mark.parametrize("space", one_in(2, ["p1-disc", "p2-disc", "q2"]))
def test_regularised_loops_end(backend, space):
    """Close to the exact Coulomb value, its certificate held."""
    if backend == "ipopt":
        pytest.importorskip("casadi")
    problem = heavy_block(space, "plane_strain")
    exact = la.solve(problem, throw=True).load_factor
    state = la.solve(problem, backend, throw=True)
    assert state.load_factor == pytest.approx(exact, rel=0.01)
