"""What proves LOCKED and UNSAFE is kept, and holds by what is computed here from public fields."""

from dataclasses import replace
from math import radians, sin

import numpy as np
import pytest
from skfem import Basis, ElementTriP2, ElementVector, LinearForm, asm

import lacore as la
from lacore.coupling.claims import dead_collapse, locking_ray
from lacore.reporting.status import Status

ROUND_OFF = 1e-12  # of all forces: sums of a few hundred terms


def in_a_box(material):
    """A body that its own weight presses into a box that holds all its sides."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=2, ny=2)
    return la.Problem(
        {"soil": la.Body(mesh, material)},
        [la.BodyForce("soil", (0, -3.0))],
        [la.Fix("soil", side) for side in ("left", "right", "bottom", "top")],
    )


def slope():
    """Sand at 45 degrees with 30, under its own weight and a push that cannot hold it."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
    mesh = mesh.with_boundaries({"crest": lambda x: (x[1] > 1 - 1e-9) & (x[0] > 1)})
    shape = mesh.p.copy()
    shape[0] = shape[0] + (1 - shape[0] / 2) * shape[1]
    leaning = type(mesh)(shape, mesh.t, _boundaries=mesh.boundaries)
    return la.Problem(
        {"sand": la.Body(leaning, la.MohrCoulomb(0.0, 30))},
        [la.Pressure("sand", "crest")],
        [la.Fix("sand", "bottom"), la.Fix("sand", "right")],
        dead_loads=[la.BodyForce("sand", (0, -1))],
    )


def left_over(problem, stress, force):
    """Nodal forces of stresses at vertices less those of a force per volume, inside the mesh.

    Per sum of the latter: the gradients of quadratic velocities are linear, as stresses are, and
    by the vertex rule of the body their power is a third of that at each vertex.
    """
    mesh = problem.bodies["soil"].mesh
    corners = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    element = ElementVector(ElementTriP2())
    at_corners = Basis(mesh, element, quadrature=(corners, np.full(3, 1 / 6)))
    xx, yy, _, xy = np.moveaxis(stress, -1, 0)

    @LinearForm
    def power(v, w):
        g = v.grad
        return w.xx * g[0, 0] + w.yy * g[1, 1] + w.xy * (g[0, 1] + g[1, 0])

    @LinearForm
    def load(v, w):
        return force * v[1] + 0 * w.x[0]

    basis = Basis(mesh, element)
    inner = basis.complement_dofs(basis.get_dofs())
    loads = asm(load, basis)[inner]
    left = asm(power, at_corners, xx=xx, yy=yy, xy=xy)[inner] - loads
    return np.abs(left).max() / np.abs(loads).sum()


@pytest.mark.parametrize(
    ("material", "growing"),
    [
        (la.MohrCoulomb(1.0, 30), 0.5),
        (la.MohrCoulomb(1.0, 30, dilation_angle=10), sin(radians(10))),
        (la.MohrCoulomb(1.0, 30, dilation_angle=0), 0.0),
        (la.VonMises(1.0), 0.0),
    ],
)
def test_stresses_that_grow_without_end_carry_the_load(material, growing):
    """In balance at every node, and in the cone ``q <= -sin(psi) P`` that has no strength."""
    problem = in_a_box(material)
    state = la.solve(problem)
    assert state.status is Status.LOCKED
    assert state.ray.proves
    stress = replace(state, point=state.ray.point).effective_stress["soil"]
    assert left_over(problem, stress, -3.0) <= ROUND_OFF
    assert left_over(problem, 1.001 * stress, -3.0) > ROUND_OFF
    xx, yy, _, xy = np.moveaxis(stress, -1, 0)
    beyond = np.hypot((xx - yy) / 2, xy) + growing * (xx + yy) / 2
    assert beyond.max() <= ROUND_OFF * np.abs(stress).max()
    assert "out of balance" in str(state)


@pytest.mark.parametrize("backend", ["clarabel-regularised", "interior_point"])
def test_a_ray_is_there_whoever_solves(backend):
    state = la.solve(in_a_box(la.MohrCoulomb(1.0, 30)), backend)
    assert state.status is Status.LOCKED
    assert state.ray.proves


def test_bounds_keep_their_rays():
    """In balance in each element: linear stresses whose divergence is the weight."""
    problem = in_a_box(la.MohrCoulomb(1.0, 30))
    assert la.upper_bound(problem).ray.proves
    bound = la.lower_bound(problem)
    assert bound.status is Status.LOCKED
    assert bound.ray.proves
    stress = replace(bound, point=bound.ray.point).effective_stress["soil"]
    mesh = problem.bodies["soil"].mesh
    corners = np.concatenate([mesh.p[:, mesh.t], np.ones((1, *mesh.t.shape))])
    gradient = np.linalg.inv(corners.transpose(2, 1, 0))  # of what is linear: values to (x, y, 1)
    by = np.einsum("eij,ejs->eis", gradient, stress)
    assert by[:, 0, 0] + by[:, 1, 3] == pytest.approx(0.0, abs=1e-9)
    assert by[:, 0, 3] + by[:, 1, 1] == pytest.approx(3.0, abs=1e-9)


@pytest.mark.parametrize("coupling", ["associated", "stick"])
def test_reactions_of_a_block_that_is_pressed_on_an_incline(coupling):
    """By normal forces, and friction within its cone: the normal and tangential part of 10."""
    angle, friction = 0.2, 0.3
    along = np.array([np.cos(angle), np.sin(angle)])
    out = np.array([-np.sin(angle), np.cos(angle)])
    block = la.RigidBlock([0 * along, 2 * along, 2 * along + out, out])
    problem = la.Problem(
        {"b": block},
        [la.BodyForce("b", (0, -5.0))],
        interfaces=[
            la.Interface(
                ("b", lambda x: np.abs(out @ x) < 1e-9),
                la.RigidObstacle((0, 0), tuple(out)),
                friction,
            )
        ],
        dead_loads=[la.BodyForce("b", (0, -1.0))],
    )
    state = la.solve(problem, coupling=coupling)
    assert state.status is Status.LOCKED
    table = replace(state, point=state.ray.point).reactions
    assert table["t_n"] @ table["length"] == pytest.approx(10 * np.cos(angle), rel=1e-12)
    # The tangent is the normal turned by +90 degrees: down the incline.
    assert table["t_t"] @ table["length"] == pytest.approx(-10 * np.sin(angle), rel=1e-12)
    assert table["t_n"].min() >= 0
    if coupling == "associated":
        most = friction * table["t_n"] + ROUND_OFF * table["t_n"].max()
        assert np.all(table["t_t"].abs() <= most)


def test_a_slope_that_is_too_steep_keeps_its_mechanism():
    """The push does not feel it, and sand without cohesion dissipates nothing."""
    state = la.solve(slope())
    assert state.status is Status.UNSAFE
    assert state.ray.proves(state.tolerance)
    full, u = state.discretisation.full, state.ray.point.velocity
    assert full.dead_load @ u == pytest.approx(1.0, rel=1e-9)
    push = np.abs(full.reference_load).sum() * np.abs(u).max()
    assert abs(full.reference_load @ u) <= state.tolerance * push
    (sand,) = full.groups
    size, growth = np.linalg.norm(sand.cone_vectors(u), axis=1), sand.volumetric @ u
    assert np.max(size / 2 - growth) <= state.tolerance * size.max()
    assert state.ray.dissipated_share <= state.tolerance
    assert "dissipated" in str(state)


@pytest.mark.parametrize("dilation", [0, 10])
def test_a_range_of_a_soil_keeps_what_proves_that_there_is_none(dilation):
    found = la.soil_range(in_a_box(la.MohrCoulomb(1.0, 30, dilation_angle=dilation)))
    assert found.status is Status.LOCKED
    assert found.ray.proves
    assert "out of balance" in str(found)
    fallen = slope()
    sand = replace(
        fallen.bodies["sand"], criterion=la.MohrCoulomb(0.0, 30, dilation_angle=dilation)
    )
    found = la.soil_range(replace(fallen, bodies={"sand": sand}))
    assert found.status is Status.UNSAFE
    assert found.ray.proves(1e-6)
    assert found.bracket == (-np.inf, np.inf)
    assert "no bounds" in repr(found)
    open_above = repr(replace(found, bracket=(-3.0, np.inf)))
    assert "[-3, inf]" in open_above


def test_nothing_that_is_nan_proves_anything():
    locked = la.solve(in_a_box(la.MohrCoulomb(1.0, 30))).ray
    for name in ("residual", "beyond", "release"):
        assert not replace(locked, **{name: np.nan}).proves
    unsafe = la.solve(slope()).ray
    for name in ("power", "dissipated_share", "felt", "impossible"):
        assert not replace(unsafe, **{name: np.nan}).proves(1e-6)


def test_a_ray_of_nan_leaves_a_claim_unproven(monkeypatch):
    carried = locking_ray._carried
    prove = locking_ray.prove_dead_loads

    def of_nan(*given):
        found = prove(*given)
        return replace(found, equilibrium=found.equilibrium.scaled(np.nan))

    monkeypatch.setattr(locking_ray, "_carried", lambda *given: np.nan * carried(*given))
    monkeypatch.setattr(locking_ray, "prove_dead_loads", of_nan)
    state = la.solve(in_a_box(la.MohrCoulomb(1.0, 30)))
    assert (state.status, state.ray) == (Status.NOT_CERTIFIED, None)
    by_cones = dead_collapse._by_cones
    monkeypatch.setattr(dead_collapse, "_by_cones", lambda *given: np.nan * by_cones(*given))
    state = la.solve(slope())
    assert (state.status, state.ray) == (Status.NOT_CERTIFIED, None)


def test_a_state_that_is_solved_has_no_ray():
    assert la.solve(la.examples.column(friction=0.3)).ray is None
