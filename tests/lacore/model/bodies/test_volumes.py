"""Conditions of volume that depend on each other: which of them say all (T24, T27)."""

from dataclasses import replace

import numpy as np
import pytest
from skfem.mesh import MeshTri2

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact, dimensionless
from lacore_backends.clarabel_socp import Clarabel

ROUND_OFF = 1e-12
SOLVED = 1e-6  # of powers: the solver's gap is below 1e-7
STEEL = la.VonMises(shear_strength=1.0)
CELLS = 3, 2


def bent(mesh):
    """Its midside nodes moved off the middle, within a tenth of their edges."""
    curved = MeshTri2.from_mesh(mesh)
    points = curved.doflocs.copy()
    middles = np.arange(mesh.nvertices, points.shape[1])
    inner = np.setdiff1d(middles, mesh.nvertices + mesh.boundary_facets())
    points[:, inner] += 0.02 * np.random.default_rng(1).uniform(-1, 1, (2, inner.size))
    named = replace(curved, doflocs=points).with_boundaries(mesh.boundaries)
    return named.with_subdomains(mesh.subdomains or {})


def upset(mesh, criterion=STEEL, **more):
    """Pressed from below, held by what is smooth at its top: it moves out to the right."""
    return la.discretise(
        la.Problem(
            {"block": la.Body(mesh, criterion, **more)},
            [la.RigidFooting("block", "bottom", (0, 1), rough=False)],
            supports=[la.Fix("block", "left", "x"), la.Fix("block", "top")],
        )
    )


CROSSED = la.meshes.rectangle((0, 1), (0, 1), *CELLS)
SQUARES = la.meshes.quadrilaterals((0, 1), (0, 1), *CELLS)
COUNT = CELLS[0] * CELLS[1]
MODELS = {
    # Eleven of the twelve conditions of four triangles, four of the nine of a quadrilateral.
    "curved": (lambda: upset(bent(CROSSED), space="p2-gauss"), 11 * COUNT),
    "revolved": (lambda: upset(CROSSED, space="p2-gauss", kinematics="axisymmetric"), 11 * COUNT),
    "quadrilaterals": (lambda: upset(SQUARES, space="q2"), 4 * COUNT),
    "of revolution": (lambda: upset(SQUARES, space="q2", kinematics="axisymmetric"), 4 * COUNT),
}


@pytest.mark.parametrize("model", MODELS)
def test_they_are_independent_and_say_all(model):
    make, count = MODELS[model]
    (group,) = make().full.groups
    combined, roots = group.conditions.toarray(), np.sqrt(group.weights)[:, None]
    assert combined @ combined.T == pytest.approx(np.eye(count), abs=ROUND_OFF)
    rows, said = roots * group.volumetric.toarray(), group.conditioned.toarray()
    size = np.abs(rows).max()
    assert said == pytest.approx(combined @ rows, abs=ROUND_OFF * size)
    assert combined.T @ said == pytest.approx(rows, abs=ROUND_OFF * size)


@pytest.mark.parametrize("model", MODELS)
def test_they_are_as_sparse_as_elements_let_them_be(model):
    """What is within an element has no entries of others, by round-off or otherwise."""
    (group,) = MODELS[model][0]().full.groups
    entries = np.diff(group.conditioned.indptr)
    if "q" in model or "of" in model:  # two velocities at nine nodes
        assert entries.max() <= 18
    else:  # eight of eleven: two velocities at six nodes
        assert np.sum(entries <= 12) >= 8 * COUNT


@pytest.mark.parametrize("model", MODELS)
def test_answers_are_those_of_all_rows(model):
    """With mean stresses that are in equilibrium at each strain point."""
    d = MODELS[model][0]()
    program = dimensionless(d.program, d.natural)
    plain = replace(
        program, groups=tuple(replace(group, conditions=None) for group in program.groups)
    )
    contact = associated_contact(program.contact)
    loads = []
    for own in (program, plain):
        point = Clarabel().prepare(own, Clarabel.Options()).solve(contact).point
        assert certify(plain, point, contact).holds(SOLVED)
        loads.append(point.load_factor)
    assert loads[0] == pytest.approx(loads[1], rel=SOLVED)


def test_four_triangles_of_two_materials_keep_all_their_rows():
    """Whose mean stresses are in two groups; all others are as they were."""
    left = CROSSED.with_subdomains({"one": lambda x: x[0] < 0.5, "rest": lambda x: x[0] >= 0.5})
    d = upset(
        bent(left),
        {"one": STEEL, "rest": la.VonMises(shear_strength=2.0)},
        space="p2-gauss",
    )
    points = sum(group.weights.size for group in d.full.groups)
    kept = sum(group.conditions.shape[0] for group in d.full.groups)
    assert kept == points - COUNT + CELLS[1]  # the middle column of cells is of both
    assert la.solve(d).certificate.holds(SOLVED)


def test_others_have_none():
    """Straight triangles, a cut along one diagonal, soil: none is projected, or each is used."""
    sand = la.MohrCoulomb(cohesion=1.0, friction_angle=30)
    assert upset(CROSSED, space="p2-gauss").full.groups[0].conditions is None
    assert upset(SQUARES, sand, space="q2").full.groups[0].conditions is None
    cut = la.meshes.rectangle((0, 1), (0, 1), *CELLS, crossed=False)
    whole = upset(cut, space="p2-gauss", kinematics="axisymmetric").full.groups[0]
    assert whole.conditions is None
