"""Cases through every space: exact where it holds the mechanism, strict where it says so."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.continuum.spaces import SPACES
from lacore_verification.catalogue.catalogue import catalogue
from tests.shares import one_in

STRICT = [name for name, space in SPACES.items() if space.strict]
EXACT = 1e-5  # as `exact_patch`: what is left is solving


def quadrilaterals(mesh):
    """The cells of a crossed rectangle: lines through the vertices of its boundary."""
    outer = mesh.p[:, mesh.boundary_nodes()]
    (left, bottom), (right, top) = outer.min(axis=1), outer.max(axis=1)
    columns = np.sort(outer[0, outer[1] == bottom])
    rows = np.sort(outer[1, outer[0] == left])
    made = la.meshes.quadrilaterals((left, right), (bottom, top), columns.size - 1, rows.size - 1)
    x, y = np.meshgrid(columns, rows, indexing="ij")
    at = [
        np.searchsorted(np.unique(line), line) for line in made.p
    ]  # equal cells, moved to the lines of the mesh
    return replace(made, doflocs=np.stack([x[at[0], at[1]], y[at[0], at[1]]]))


def solved(case_id, variant, space):
    case = catalogue()[case_id]
    (chosen,) = (v for v in case.variants if v.name == variant)
    problem = case.problem(chosen, "coarse")
    (name, body), *_ = problem.bodies.items()
    mesh = quadrilaterals(body.mesh) if space == "q2" else body.mesh
    stated = replace(problem, bodies={name: replace(body, mesh=mesh, space=space)})
    return la.solve(stated, throw=True), case.reference(**chosen.parameters).high


@pytest.mark.parametrize("space", one_in(2, SPACES))
@pytest.mark.parametrize(
    ("case_id", "variant", "holds"),
    [
        # Rigid sliding is in every space, a cut along diagonals of cells in those on triangles.
        ("shear-patch", "sliding", SPACES),
        ("shear-patch", "yielding", [name for name in SPACES if name != "q2"]),
        ("deformable-block", "sliding", SPACES),
        ("deformable-block", "crushing", [name for name in SPACES if name != "q2"]),
        # The cut ends in a corner of the quarter: without jumps it is a band there.
        ("platens-square", "mu-0.1", ["p1-disc", "p2-disc"]),
    ],
)
def test_value(case_id, variant, holds, space):
    state, exact = solved(case_id, variant, space)
    assert state.certificate.holds(1e-6)
    if space in holds:
        assert state.load_factor == pytest.approx(exact, rel=EXACT)
    else:
        # A band in place of a cut, on 12 to 36 elements: 2.4 % with q2, without diagonals.
        assert state.load_factor == pytest.approx(exact, rel=0.03)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("variant", one_in(2, ["mu-0.05", "mu-0.1", "mu-0.2", "mu-0.3"]))
def test_platens_with_friction(variant, space):
    """Coulomb friction: no bound, and no space far from the others on 32 elements."""
    state, exact = solved("platens-coulomb", variant, space)
    assert state.rigor is la.Rigor.DISCRETE
    assert state.load_factor == pytest.approx(exact, rel=0.05)


@pytest.mark.parametrize("space", STRICT)
@pytest.mark.parametrize("variant", ["smooth", "rough"])
def test_punch(variant, space):
    state, exact = solved("prandtl-punch", variant, space)
    assert state.rigor is la.Rigor.UPPER
    assert state.load_factor >= exact
