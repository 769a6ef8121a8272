"""Meshes from which brackets start."""

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket import starts
from lacore.bounds.bracket.whole import in_bounding_spaces
from tests.lacore.models import CRITERION, punch

SAND, OBSTACLE = la.MohrCoulomb(1.0, 20.0), la.RigidObstacle()


def pressed(criterion=CRITERION, law=None, top="top"):
    """A body of 2 m x 1 m under a pressure on its top, or on a part of it, on a rough base."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 2)
    held = [la.Fix("b", "bottom")] if law is None else [la.Fix("b", "left")]
    contact = [] if law is None else [la.Interface(("b", "bottom"), OBSTACLE, law)]
    return la.Problem({"b": la.Body(mesh, criterion)}, [la.Pressure("b", top)], held, contact)


def half(x):
    return (x[1] == 1) & (x[0] <= 1)


@pytest.mark.parametrize(
    ("problem", "given", "apart", "fans"),
    [
        (pressed(), {}, False, False),
        (pressed(top=half), {}, False, False),
        (pressed(SAND), {}, False, False),
        (pressed(SAND, top=half), {}, True, True),
        (pressed(SAND, top=half), {"meshes": "shared"}, False, False),
        (pressed(top=half), {"meshes": "separate"}, True, True),
        (pressed(law=la.Coulomb(0.3)), {}, True, False),
        (pressed(law=la.Tresca(0.3)), {}, False, False),
        (pressed(), {"lower_mesh": la.meshes.rectangle((0, 2), (0, 1), 4, 2)}, True, False),
    ],
)
def test_bounds_have_separate_meshes_where_their_errors_are_elsewhere(problem, given, apart, fans):
    """Singular points of soils with friction, and friction that has two bounding problems."""
    given = {"meshes": None, "lower_mesh": None} | given
    found = starts.starts(problem, 0.1, 5000, **given)
    elements = problem.bodies["b"].mesh.nelements
    kinds = [("lower",), ("upper",)] if apart else [("lower", "upper")]
    assert [own.kinds for own in found] == kinds
    sizes = [own.problem.bodies["b"].mesh.nelements for own in found]
    assert (sizes[0] > elements) == fans
    assert sizes[-1] == elements


@pytest.mark.parametrize(
    ("law", "given", "field"),
    [
        (None, {"meshes": "shared", "lower_mesh": punch().bodies["soil"].mesh}, "lower_mesh"),
        (la.Coulomb(0.3), {"meshes": "shared", "lower_mesh": None}, "meshes"),
        (None, {"meshes": "one", "lower_mesh": None}, "meshes"),
    ],
)
def test_two_bounds_that_need_two_meshes_do_not_share_one(law, given, field):
    with pytest.raises(la.InputError, match=f"^{field}"):
        starts.starts(pressed(law=law), 0.1, 5000, **given)


def test_slivers_and_fine_starts_are_rejected():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    starts._check("problem", mesh, mesh.nelements)
    with pytest.raises(la.InputError, match="max_elements"):
        starts._check("problem", mesh, mesh.nelements - 1)
    flat = type(mesh)(mesh.p * np.array([[1.0], [1e-3]]), mesh.t)
    with pytest.raises(la.InputError, match="sliver"):
        starts._check("problem", flat, 100)


def test_a_lower_mesh_is_one_of_the_same_problem():
    """Its domain and its water are those of the problem between vertices, too."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)

    def problem(*loads):
        body = la.Body(mesh, CRITERION)
        return la.Problem(
            {"soil": body},
            [la.Traction("soil", "top", (1, 0))],
            [la.Fix("soil", "bottom")],
            dead_loads=loads,
        )

    finer = la.meshes.rectangle((0, 1), (0, 1), 3, 3)
    given = starts._given(problem(), finer)
    assert given.bodies["soil"].mesh.nelements == finer.nelements
    level = la.PorePressure("soil", lambda x: 2 - x[1])
    starts._given(problem(level), finer)
    with pytest.raises(la.InputError, match="other water between its vertices"):
        starts._given(problem(la.PorePressure("soil", lambda x: x[0] ** 2)), finer)
    larger = la.meshes.rectangle((0, 2), (0, 1), 3, 3)
    with pytest.raises(la.InputError, match="covers another domain"):
        starts._given(problem(), larger)


CONE, STEEP = la.DruckerPrager(1.0, 20.0), la.DruckerPrager(1.0, 60.0, "compression")
PRESSED = la.RigidFooting("b", "top", (0, 0, -1))
SMOOTH = la.RigidFooting("b", "top", (0, 0, -1), rough=False)
TWISTED = la.Twist("b", "top", (0, 0, 1))


@pytest.mark.parametrize(
    ("criterion", "components", "load", "law", "separates"),
    [
        (CRITERION, "x", PRESSED, la.SMOOTH, True),
        (CONE, "xyz", PRESSED, None, True),
        (CONE, "normal", SMOOTH, None, True),
        (CONE, "x", PRESSED, None, False),
        (CONE, "xyz", TWISTED, None, False),
        (CONE, "xyz", PRESSED, la.SMOOTH, False),
        (STEEP, "xyz", PRESSED, None, False),
    ],
)
def test_soil_in_space_is_cut_where_it_can_separate_from_all_that_holds_it(
    criterion, components, load, law, separates
):
    """Slip of soil dilates: not along a face that is held in its plane only (T94)."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    body = la.Body(mesh, criterion, kinematics="3d", space="p2-vertex")
    held = [la.Fix("b", "bottom", components), la.Fix("b", "back", "xyz")]
    contact = [] if law is None else [la.Interface(("b", "left"), OBSTACLE, law)]
    problem = la.Problem({"b": body}, [load], held, contact)
    space = in_bounding_spaces(problem).bodies["b"].space
    assert space == ("p2-disc" if separates else "p2-vertex")
