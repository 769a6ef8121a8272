"""Joints in space that crush (T95): closed forms, sides, invariances, proofs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lacore as la
from tests.coulomb_checker_3d import accepts, residuals
from tests.lacore.model.bodies.blocks3d.solids import box, moved
from tests.statements_3d import stated

B, H, D = 0.4, 1.0, 0.6
WEIGHT = 20e3  # N/m^3
PRESSED = WEIGHT * H  # Pa, of the pier on its floor
PIER = {"floor": box((0, 0, -0.2), (B, D, 0)), "pier": box((0, 0, 0), (B, D, H))}


def shaken(blocks, held, way=(1, 0, 0), weight=WEIGHT, down=(0, 0, -1)):
    return la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", held)],
        dead_loads=[la.BodyForce("blocks", tuple(weight * np.array(down)))],
        reference_loads=[la.BodyForce("blocks", tuple(weight * np.array(way)))],
    )


def pier(crushing, friction=5.0, way=(1, 0, 0)):
    return shaken(la.BlockAssembly3D(PIER, la.Coulomb(friction), crushing=crushing), "floor", way)


def load(problem, **options):
    return la.solve(problem, throw=True, **options).load_factor


@pytest.mark.parametrize("divisions", [1, 2, 3, 5])
@pytest.mark.parametrize("stronger", [1.5, 4.5, 50.0, 1e4])
def test_a_pier_that_turns_on_its_toe_comes_from_below(divisions, stronger):
    exact = B * (1 - 1 / stronger) / H
    found = load(pier(la.Crushing(stronger * PRESSED, divisions)))
    assert found <= exact + 1e-7  # certified to 1e-7 of the weight
    assert exact - found <= B / H / (2 * divisions**2) + 1e-7  # the widest row is as deep


@pytest.mark.parametrize("way", [(1, 0, 0), (-1, 0, 0), (0, 1, 0)])
@pytest.mark.parametrize("rows", [1, 2, 3])
def test_a_toe_as_deep_as_rows_of_cells_is_exact(way, rows):
    depth = (rows / 3) ** 2 / 2  # of the width
    width = abs(np.dot(way[:2], (B, D)))
    exact = width * (1 - depth) / H
    assert load(pier(PRESSED / depth, way=way)) == pytest.approx(exact, abs=1e-7)


def test_a_corner_crushes_on_a_triangle():
    # Pushed along a diagonal of a square pier, N = f s^2/2 stands on a triangle with legs s, whose
    # centroid is s/3 from both sides: alpha h/(2 sqrt 2) = b/2 - s/3 about both axes.
    square = {"floor": box((0, 0, -1), (1, 1, 0)), "pier": box((0, 0, 0), (1, 1, 2))}
    way, found = np.array([1, 1, 0]) / np.sqrt(2), []
    strength = 2 * WEIGHT / (0.5 * 0.6**2)
    for divisions in (2, 4, 8):
        law = la.Crushing(strength, divisions)
        own = la.BlockAssembly3D(square, la.Coulomb(5.0), crushing=law)
        found.append(load(shaken(own, "floor", way), coupling="associated"))
    exact = np.sqrt(2) * (0.5 - 0.6 / 3)
    assert np.all(np.diff(found) > 0)
    assert found[-1] <= exact
    # Cells that the edge of the triangle cuts are .12 wide there and lose what a chord does; rows
    # are four times as thin at twice the divisions, and what they lose falls at least by two.
    assert exact - found[-1] < (exact - found[-2]) / 2 < (exact - found[-3]) / 4


def test_sliding_does_not_crush():
    assert load(pier(1e6, friction=0.3)) == pytest.approx(0.3, abs=1e-7)


def test_without_bound_it_is_what_the_cells_carry_at_any_pressure():
    law = la.Crushing(1e8 * PRESSED, 2)
    assert load(pier(law)) == pytest.approx(B / H * (1 - 1 / 8), abs=1e-7)


def test_more_strength_carries_no_less():
    def dome(strength):
        own = la.masonry3d.dome(5, 2, 1.0, 0.2, 0.4, 0.6, crushing=la.Crushing(strength, 2))
        base = tuple(name for name in own.names if name.startswith("base"))
        return load(shaken(own, base), coupling="associated")

    found = np.array([dome(strength) for strength in (4e4, 6e4, 1e5, 1e6, 1e7)])
    assert np.all(np.diff(found) > -1e-6)  # the bar of certificates
    assert found[-1] > 1.01 * found[0]  # it does crush


def corner(crushing, turn=None, scale=1.0, reverse=False):
    built = la.masonry3d.corner((2, 2), 3, 0.6)
    blocks = {
        name: moved(own, turn, scale=scale)
        for name, own in list(built.polyhedra.items())[:: -1 if reverse else 1]
    }
    own = la.BlockAssembly3D(blocks, 0.6, crushing=crushing)
    axes = np.eye(3) if turn is None else turn.as_matrix()
    way, down = axes @ (-0.6, -0.8, 0), axes @ (0, 0, -1)
    return shaken(own, "base", way, WEIGHT / scale, down)


def test_turned_scaled_and_renumbered_it_is_the_same():
    law = la.Crushing(3e4, 2)
    turn = Rotation.from_rotvec((0.3, -0.5, 0.9))
    want = load(corner(law), coupling="associated")
    assert want < (1 - 1e-3) * load(corner(None), coupling="associated")
    for other in ({"turn": turn}, {"scale": 1e-3}, {"scale": 1e3}, {"reverse": True}):
        assert load(corner(law, **other), coupling="associated") == pytest.approx(want, rel=1e-6)


def test_a_weight_that_crushes_its_joint_is_unsafe_by_its_mechanism():
    problem = pier(0.95 * PRESSED)
    state = la.solve(problem)
    assert state.status is la.Status.UNSAFE
    motion = state.velocity["blocks"][:, 1]
    joints = problem.bodies["blocks"].joints
    arm = joints.points - np.array([[B / 2], [D / 2], [H / 2]])
    falling = -(motion[:3, None] + np.cross(motion[3:], arm, axis=0))[2]
    weight = PRESSED * B * D
    assert -weight * motion[2] == pytest.approx(1, abs=1e-6)  # the power of the dead load
    crushing = 0.95 * PRESSED * joints.weight @ np.maximum(falling, 0)
    assert crushing < 1 - 1e-3


@pytest.fixture(scope="module")
def certified():
    problem = corner(la.Crushing(3e4, 2))
    return problem, la.solve(problem, throw=True)


def test_the_checker_accepts_what_is_certified(certified):
    problem, state = certified
    s = stated(problem, state)
    assert accepts(s), residuals(s)
    assert (state.reactions["state"] == "crush").any()
    assert np.all(state.reactions["u_n"][state.reactions["state"] == "crush"] < 0)


def test_the_checker_refuses_what_is_beyond_the_strength(certified):
    s = stated(*certified)
    weak = residuals(replace(s, strength=0.99 * s.strength))
    assert weak["crushing"] > 1e-6
    assert weak["power"] > 1e-6
    assert residuals(replace(s, area=1.01 * s.area))["area"] > 1e-3
    less = residuals(replace(s, strength=1.01 * s.strength))  # crushes below its strength
    assert less["crushing at strength"] > 1e-6


def test_the_certificate_sees_a_pressure_beyond_the_strength(certified):
    _, state = certified
    assert state.certify().holds(1e-6)
    table = state.reactions.copy()
    most = table["t_n"].idxmax()
    table.loc[most, "t_n"] *= 1.01
    assert not state.certify(reactions=table).holds(1e-6)
    stress = [own.copy() for own in state.point.stress]
    stress[0][np.argmax(np.abs(stress[0]))] *= 1.01
    beyond = state.certify(point=replace(state.point, stress=tuple(stress)))
    assert beyond.yield_violation == pytest.approx(0.01, abs=1e-6)


def test_what_the_strength_is_not_for_is_refused():
    own = la.BlockAssembly3D({"pier": PIER["pier"]}, 0.5, crushing=1e6)
    with pytest.raises(la.InputError, match="crush"):
        la.Problem(
            bodies={"blocks": own},
            interfaces=[
                la.Interface(
                    ("blocks", lambda x: x[2] == 0), la.RigidObstacle((0, 0, 0), (0, 0, 1)), 0.5
                )
            ],
            dead_loads=[la.BodyForce("blocks", (0, 0, -1))],
            reference_loads=[la.BodyForce("blocks", (1, 0, 0))],
        )


@pytest.mark.parametrize(
    ("law", "carried"),
    [
        (la.Tresca(3e3), 3e3 / PRESSED),
        (la.Coulomb(0.2, adhesion=1e3), 0.2 + 1e3 / PRESSED),
        (la.Coulomb(0.2, adhesion=1e3, associated=True), 0.2 + 1e3 / PRESSED),
    ],
)
def test_cohesion_of_mortar_acts_on_the_area_of_cells(law, carried):
    own = la.BlockAssembly3D(PIER, law, crushing=1e6)
    state = la.solve(shaken(own, "floor"), throw=True)
    assert state.load_factor == pytest.approx(carried, abs=1e-7)
    assert state.certificate.holds(1e-6)
