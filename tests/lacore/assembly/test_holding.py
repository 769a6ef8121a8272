"""Velocities that supports, footings and driven blocks leave free."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.assembly.holding import slides_on_chords
from lacore.assembly.natural import with_speeds_of_crushing
from lacore.assembly.unknowns import Unknowns
from lacore.assembly.water import effective_stress, total_stress
from lacore.paths.stage import ProblemOnPath
from tests.lacore.model.bodies.blocks3d.solids import box

K = la.VonMises(1.0)


def unit(x):
    return {"block": [(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)]}


def driven(motions, supports=(), friction=0.3):
    """Three rigid blocks in a row, some of which a path drives at given velocities."""
    names = ("one", "two", "three")
    bodies = {name: la.BlockAssembly(unit(2.0 * k), 0.3) for k, name in enumerate(names)}
    return ProblemOnPath(
        bodies,
        [la.PointForce("one", "block", (1, 0)), la.PointForce("three", "block", (0, 1))],
        list(supports),
        [la.Interface((name, "block"), la.RigidObstacle(), friction) for name in names],
        dead_loads=[la.BodyForce(name, (0, -1)) for name in names],
        drives={name: np.array(motion, dtype=float) for name, motion in motions.items()},
    )


def test_driven_blocks_move_by_one_unknown_in_proportion():
    """The third block is free; of the two driven ones only the common speed is left."""
    motions = {"one": (1.0, 0.0, 0.5), "two": (-2.0, 3.0, 0.0)}
    d = discretise(driven(motions))
    basis = d.free_basis.toarray()
    assert basis.shape == (9, 1 + 3)
    rows = {name: np.arange(own.count) + own.offset for name, own in d.blocks.items()}
    (moving,) = np.flatnonzero(basis[rows["one"]].any(axis=0))
    for name, motion in motions.items():
        own = basis[rows[name], moving]
        assert own == pytest.approx(d.blocks[name].unknowns(np.array(motion)[:, None]))
    assert not basis[rows["three"], moving].any()
    others = np.delete(basis, moving, axis=1)
    assert np.linalg.matrix_rank(others[rows["three"]]) == 3
    assert not others[np.r_[rows["one"], rows["two"]]].any()


def test_blocks_driven_at_rest_are_held():
    d = discretise(driven({"one": (0, 0, 0), "two": (0, 0, 0)}))
    assert d.free_basis.shape == (9, 3)
    one = d.blocks["one"]
    assert not d.free_basis[one.offset : one.offset + one.count].nnz


@pytest.mark.parametrize(
    ("motion", "possible"),
    [((1, 0, 0), True), ((0, 1, 0), False), ((1, 1e-3, 0), False), ((1, 1e-12, 0), True)],
)
def test_a_block_is_not_driven_against_a_support(motion, possible):
    """The support lets it move along x only; round-off of 1e-12 is no other motion."""
    problem = driven({"two": motion}, [la.Fix("two", "block", "y")], la.SMOOTH)
    if possible:
        assert discretise(problem).free_basis.shape == (9, 3 + 1 + 3)
        return
    with pytest.raises(la.InputError, match=r"ToolTravel\.velocity\['two'\].*a support holds"):
        discretise(problem)


def polygon(turn, edges=4):
    """A sector of a ring of straight edges, each of which turns by an angle, in degrees."""
    flat = la.meshes.rectangle((1, 2), (0, 1), 1, edges)
    angle = np.radians(turn) * edges * flat.p[1]
    points = flat.p[0] * np.stack([np.cos(angle), np.sin(angle)])
    inner = flat.boundaries["left"]
    mesh = type(flat)(points, flat.t)
    named = {"arc": inner, "end": flat.boundaries["bottom"]}
    return mesh.with_boundaries({name: np.asarray(own) for name, own in named.items()})


def ring(turn, where="arc", rough=False, components=None, geometry="approximated"):
    """The sector with a footing on its inner side, or held there in some components."""
    body = la.Body(polygon(turn), K, geometry=geometry)
    loads = [la.Traction("ring", "end", (1, 1))]
    supports = []
    if components is None:
        loads = [la.RigidFooting("ring", where, (1, 0), rough=rough)]
    else:
        supports = [la.Fix("ring", where, components)]
    return la.Problem({"ring": body}, loads, supports)


@pytest.mark.parametrize("components", ["normal", "tangential"])
@pytest.mark.parametrize(("turn", "possible"), [(0.01, False), (55.0, False), (65.0, True)])
def test_a_direction_is_held_along_straight_parts_only(components, turn, possible):
    """Edges that turn by less than 60 degrees stand for an arc; by more they are corners."""
    problem = ring(turn, components=components)
    if possible:
        discretise(problem)
        return
    with pytest.raises(la.InputError, match="turns by small angles"):
        discretise(problem)


def test_a_direction_is_held_along_a_smooth_curve():
    """Edges of a parabola are quadratic and join without corners: it glides along itself."""
    flat = la.meshes.quadrilaterals((-1, 1), (0, 1), 4, 1)
    mesh = la.meshes.isoparametric(flat, lambda x: np.stack([x[0], x[1] + x[0] ** 2]))
    problem = la.Problem(
        {"bowl": la.Body(mesh, K, space="q2")},
        [la.Traction("bowl", "top", (1, 0))],
        [la.Fix("bowl", "bottom", "normal")],
    )
    d = discretise(problem)
    nodes = np.unique(d.continua["bowl"].facet_nodes(mesh.boundaries["bottom"]))
    slope = 2 * d.continua["bowl"].nodes[0, nodes]
    u_x, u_y = d.free_basis.toarray()[d.continua["bowl"].dofs[:, nodes]]
    assert u_y == pytest.approx(slope[:, None] * u_x, abs=1e-12)
    assert np.all(np.abs(u_x).max(axis=1) > 0)


def speeds_at(d, name, facets):
    """Velocities at the nodes on facets, and the speed of the footing, of each free velocity."""
    dofs = d.continua[name]
    nodes = np.unique(dofs.facet_nodes(facets))
    basis = d.free_basis.toarray()
    return dofs.nodes[:, nodes], basis[dofs.dofs[:, nodes]], basis[d.footings[0]]


@pytest.mark.parametrize(("turn", "slides"), [(15.0, True), (65.0, False)])
def test_ground_slides_along_an_arc_of_chords_and_sticks_at_corners(turn, slides):
    """Along an arc the mean of the two normals holds, at a corner each of them."""
    problem = ring(turn)
    d = discretise(problem)
    place, speed, moved = speeds_at(d, "ring", problem.bodies["ring"].mesh.boundaries["arc"])
    relative = speed - np.stack([moved, 0 * moved])[:, None]
    angle = np.degrees(np.arctan2(place[1], place[0])) % 360
    inside = np.isclose(np.hypot(*place), 1.0) & (angle > turn / 2) & (angle < 3.5 * turn)
    assert inside.sum() == 3
    outward = place / np.hypot(*place)
    along = np.stack([-outward[1], outward[0]])
    across = np.einsum("dn,dnk->nk", outward, relative)
    assert np.abs(across[inside]).max() <= 1e-12
    tangential = np.einsum("dn,dnk->nk", along, relative)
    assert (np.abs(tangential[inside]).max(axis=1) > 1e-3).tolist() == [slides] * 3


def test_a_smooth_footing_slides_on_chords_that_replace_an_arc():
    def asked(turn, **more):
        problem = ring(turn, **more)
        return slides_on_chords(problem.reference_loads[0], problem.bodies["ring"])

    assert asked(15.0)
    assert not asked(15.0, rough=True)
    assert not asked(15.0, geometry="exact")
    assert not asked(65.0)  # corners that are meant
    assert not asked(15.0, where="end")  # one straight edge


def test_curved_edges_and_faces_in_space_have_no_chords():
    flat = la.meshes.quadrilaterals((1, 2), (0, 1), 1, 2)
    mesh = la.meshes.isoparametric(
        flat, lambda x: x[0] * np.stack([np.cos(x[1] * np.pi / 2), np.sin(x[1] * np.pi / 2)])
    )
    pile = la.RigidFooting("ring", "left", (1, 0), rough=False)
    assert not slides_on_chords(pile, la.Body(mesh, K, space="q2", geometry="approximated"))
    cube = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    plate = la.RigidFooting("cube", lambda x: x[2] == 1, (0, 0, -1), rough=False)
    assert not slides_on_chords(plate, la.Body(cube, K, kinematics="3d", space="p2-disc"))


def crushing_block(strength, weight):
    """A cube on a fixed one; the joint between them crushes at a strength."""
    cubes = {name: box((0, 0, z), (1, 1, z + 1)) for name, z in (("base", -1.0), ("block", 0.0))}
    return la.Problem(
        {"blocks": la.BlockAssembly3D(cubes, 0.5, crushing=la.Crushing(strength, 1))},
        [la.BodyForce("blocks", (1, 0, 0))],
        [la.Fix("blocks", "base")],
        dead_loads=[la.BodyForce("blocks", (0, 0, -weight))],
    )


@pytest.mark.parametrize(("strength", "share"), [(1e3, None), (1e-3, 1.0)])
def test_crushing_is_as_slow_as_the_dead_load_presses_less_than_the_strength(strength, share):
    """In these units a speed of crushing costs what the speed of a block under its load costs."""
    weight = 2.0
    problem = crushing_block(strength, weight)
    d = discretise(problem)
    unknowns = Unknowns.of(problem)
    plain = csr_matrix(np.eye(d.full.n))
    scaled = with_speeds_of_crushing(plain, unknowns, d.full.dead_load).diagonal()
    crushing = d.crushing
    assert crushing.size
    others = np.setdiff1d(np.arange(d.full.n), crushing)
    assert np.all(scaled[others] == 1)
    (dofs,) = d.blocks.values()
    force = np.abs(d.full.dead_load).sum()
    pressure = force / np.cbrt(dofs.extent) ** 2
    expected = pressure / strength if share is None else share
    assert scaled[crushing] == pytest.approx(expected)
    assert np.all(with_speeds_of_crushing(plain, unknowns, 0 * d.full.dead_load).diagonal() == 1)


@pytest.mark.parametrize("strength", [1e-3, 1e3])
def test_a_dead_load_sets_the_scale_of_stress_whatever_crushes(strength):
    problem = crushing_block(strength, 2.0)
    (blocks,) = problem.bodies.values()
    firm = replace(problem, bodies={"blocks": la.BlockAssembly3D(blocks.polyhedra, 0.5)})
    assert discretise(problem).natural == discretise(firm).natural


@pytest.mark.parametrize("components", [4, 6])
def test_water_takes_no_shear_and_the_same_pressure_on_all_planes(components):
    total, water = np.arange(2.0 * components).reshape(2, components), np.array([0.5, -2.0])
    effective = effective_stress(total, water)
    assert effective[:, :3] == pytest.approx(total[:, :3] + water[:, None])  # tension is positive
    assert effective[:, 3:] == pytest.approx(total[:, 3:])
    assert total_stress(effective, water) == pytest.approx(total)
