"""Numbers whose products overflow or vanish are refused by name, wherever they come in."""

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.reporting.errors import InputError, is_number, require_range

MESH = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
RECTANGLE = la.masonry.rectangle


def mesh_with(size):
    places = MESH.p.copy()
    places[:, -1] *= size
    return MeshTri(places, MESH.t)


def problem(load):
    body = la.Body(MESH, la.VonMises(1.0))
    return la.Problem({"b": body}, [load], [la.Fix("b", "bottom")])


def hard():
    law = la.hardening.Linear(1.0, 1.0)
    body = la.Body(MESH, la.VonMises(hardening=law), space="p2-gauss")
    return la.Problem({"b": body}, [la.RigidFooting("b", "top", (0, -1))], [la.Fix("b", "bottom")])


ENTRIES = {
    "vertices of a mesh": lambda s: la.Body(mesh_with(s), la.VonMises(1.0)),
    "all of a mesh": lambda s: la.Body(MeshTri(s * MESH.p, MESH.t), la.VonMises(1.0)),
    "makers of meshes": lambda s: la.meshes.rectangle((0, s), (0, 1), 2, 2),
    "quadrilaterals": lambda s: la.meshes.quadrilaterals((0, s), (0, s), 2, 2),
    "rings": lambda s: la.Body(la.meshes.quarter_ring(s, 2 * s, 2, 2), la.VonMises(1.0)),
    "a block": lambda s: la.BlockAssembly({"a": RECTANGLE(0, s, 0, 1)}, friction=0.5),
    "blocks": lambda s: la.BlockAssembly(
        {"a": RECTANGLE(0, s, -s, 0), "b": RECTANGLE(0, s, 0, s)}, friction=0.5
    ),
    "arches": lambda s: la.masonry.arch(5, s, s / 4, 0.5),
    "courses": lambda s: la.masonry.running_bond([[1, 1], [1, 1]], 0.5, block=(s, s)),
    "nodes": lambda s: la.Frame({"A": (0, 0), "B": (s, 1)}, {"m": ("A", "B")}, 1.0),
    "moments": lambda s: la.Frame({"A": (0, 0), "B": (1, 1)}, {"m": ("A", "B")}, abs(s)),
    "strengths": lambda s: la.VonMises(abs(s)),
    "points of loads": lambda s: la.discretise(problem(la.PointForce("b", (s, 0), (1, 0)))),
    "point forces": lambda s: la.PointForce("b", (0, 0), (s, 0)),
    "tractions": lambda s: la.Traction("b", "top", (0, s)),
    "pressures": lambda s: la.Pressure("b", "top", s),
    "weights": lambda s: la.BodyForce("b", (0, s)),
    "footings": lambda s: la.RigidFooting("b", "top", (0, s)),
    "points of obstacles": lambda s: la.RigidObstacle((s, 0), (0, 1)),
    "normals of obstacles": lambda s: la.RigidObstacle((0, 0), (0, s)),
    "travels": lambda s: la.sequential(hard(), s, 1),
    "points that travel": lambda s: la.sequential(
        hard(), 0.1, 1, control=la.PointTravel("b", (s, 0), (0, 1))
    ),
    "directions": lambda s: la.sequential(
        hard(), 0.1, 1, control=la.PointTravel("b", (1, 1), (0, s))
    ),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e160, -1e160, 1e308, 1e61])
@pytest.mark.parametrize("entry", ENTRIES)
def test_sizes_that_overflow_are_refused(entry, size):
    with pytest.raises(InputError):
        ENTRIES[entry](size)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "entry", ["point forces", "tractions", "pressures", "normals of obstacles"]
)
def test_loads_that_vanish_when_squared_are_refused(entry):
    for size in (1e-160, 5e-324):
        with pytest.raises(InputError, match="overflow, or vanish"):
            ENTRIES[entry](size)


WHOLE = [
    "makers of meshes",
    "nodes",
    "moments",
    "strengths",
    "point forces",
    "tractions",
    "travels",
]


@pytest.mark.parametrize("entry", WHOLE)
def test_whole_numbers_that_no_float_holds_are_refused(entry):
    with pytest.raises(InputError):
        ENTRIES[entry](10**400)
    with pytest.raises(InputError, match="not a polygon"):
        la.BlockAssembly({"a": [(0, 0), (1, 0), (10**400, 1)]}, friction=0.5)


def test_what_is_named():
    with pytest.raises(InputError, match=r"blocks\['a'\] = 1e\+160: outside of 1e-60 to 1e\+60"):
        la.BlockAssembly({"a": RECTANGLE(0, 1e160, 0, 1)}, friction=0.5)
    with pytest.raises(InputError, match=r"Frame.nodes\['B'\]"):
        ENTRIES["nodes"](1e160)


def test_zeros_and_infinite_strengths_pass():
    require_range("x", 0.0, np.inf, [0.0, 1e59], np.zeros(0))
    assert not is_number(10**400)
    assert is_number(10**300)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e-50, 1e50])
def test_a_problem_at_the_ends_of_the_range_is_solved_as_any_other(size):
    """A sheared square, k = 1: load factor 1, in units of any size."""
    mesh = MeshTri(size * MESH.p, MESH.t).with_boundaries(
        {"top": lambda x: x[1] == size, "bottom": lambda x: x[1] == 0}
    )
    stated = la.Problem(
        {"b": la.Body(mesh, la.VonMises(size))},
        [la.RigidFooting("b", "top", (1, 0), rough=True)],
        [la.Fix("b", "bottom")],
    )
    unit = la.Problem(
        {"b": la.Body(MESH, la.VonMises(1.0))},
        [la.RigidFooting("b", "top", (1, 0), rough=True)],
        [la.Fix("b", "bottom")],
    )
    found = la.solve(stated).load_factor / size
    # What the certificate lets through, twice.
    assert found == pytest.approx(la.solve(unit).load_factor, rel=2e-6)
