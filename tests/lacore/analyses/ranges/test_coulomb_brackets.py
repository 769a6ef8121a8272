"""What is proven of every Coulomb load factor, and of which problem it is said (T14)."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

import lacore as la
from lacore.analyses.ranges.continuum import continuum_range
from lacore.bounds.bracket.bracket import heading
from lacore.bounds.enclosing import associated, frictionless, has_coulomb
from lacore.reporting.status import Scope
from tests.lacore.bounds.test_rigid_bounds import footing
from tests.lacore.models import CRITERION, deformable_block
from tests.rigid_problems import block_slide, box

PRANDTL = 2 + pi
PASSIVE = (
    2.375  # of a wall with mu = 0.2 that moves in: p/k = 1 + sqrt(1 - r^2) + asin r, r = mu p/k
)


def passive_wall(mu, n=4):
    """A rigid wall pushed into weightless soil of height 1, k = 1, on a base that holds it."""
    soil = la.Body(la.meshes.rectangle((0, 3), (0, 1), 3 * n, n), CRITERION)
    wall = la.RigidBlock([(-0.3, 0), (0, 0), (0, 1), (-0.3, 1)])
    return la.Problem(
        {"soil": soil, "wall": wall},
        [la.Pressure("wall", lambda x: x[0] == -0.3, 1.0)],
        [
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("wall", lambda x: x[1] == 0, "y"),
            la.Fix("wall", lambda x: x[1] == 1, "y"),
        ],
        [la.Interface(("soil", "left"), ("wall", lambda x: x[0] == 0), mu)],
    )


def test_the_two_problems_around_a_coulomb_one():
    """Laws of interfaces and of joints; Tresca, and what is associated already, stay."""
    stated = la.Problem(
        {
            "soil": la.Body(la.meshes.rectangle((0, 2), (-1, 0), 2, 1), CRITERION),
            "blocks": la.BlockAssembly(
                {"a": box(0, 1, 0, 1), "b": box(1, 2, 0, 1), "c": box(0, 2, 1, 2)},
                la.Tresca(0.1),
                {("a", "b"): 0.5, ("b", "c"): la.Coulomb(0.2, associated=True)},
            ),
        },
        [la.BodyForce("blocks", (0, -1))],
        [la.Fix("soil", "bottom")],
        [la.Interface(("blocks", lambda x: x[1] == 0), ("soil", "top"), 0.3)],
    )
    assert has_coulomb(stated)
    below, above = frictionless(stated), associated(stated)
    assert not has_coulomb(below)
    assert not has_coulomb(above)
    assert frictionless(below) is below
    assert below.interfaces[0].law == la.SMOOTH
    assert above.interfaces[0].law == la.Coulomb(0.3, associated=True)
    for problem, law in ((below, la.SMOOTH), (above, la.Coulomb(0.5, associated=True))):
        blocks = problem.bodies["blocks"]
        assert blocks.joint_friction[("a", "b")] == law
        assert blocks.joint_friction[("b", "c")] == la.Coulomb(0.2, associated=True)
        assert blocks.friction == la.Tresca(0.1)
        assert list(problem.bodies) == list(stated.bodies)
        assert la.lower_bound(problem).status in (la.Status.SOLVED, la.Status.LOCKED)
    # The programs are those that `solve` freezes for its couplings.
    for problem, coupling in ((below, "frictionless"), (above, "associated")):
        apart, frozen = la.solve(problem), la.solve(stated, coupling=coupling)
        assert apart.status is frozen.status
    assert not has_coulomb(deformable_block(la.Tresca(0.3)))
    # What sticks keeps what it carries at any pressure.
    bedded = frictionless(deformable_block(la.Coulomb(0.5, adhesion=0.75, tension=0.5)))
    assert bedded.interfaces[0].law == la.Coulomb(0.0, adhesion=0.5, tension=0.5)


@pytest.mark.slow
def test_a_discrete_interval_is_not_called_one_of_the_continuum():
    """Its lower end lies above 2 + pi, what every Coulomb load factor of the continuum is."""
    found = la.coulomb_range(footing(0.3), restarts=0)
    assert found.scope is Scope.DISCRETE
    assert found.bracket[0] > PRANDTL
    assert found.continuum[0] < PRANDTL < found.continuum[1]
    assert not found.missing
    text = str(found)
    below, above = found.continuum
    assert f"proven of the continuum: every one lies in [{below:.6g}, {above:.6g}]" in text
    assert "proven: " not in text
    assert text.count("proven of the discrete problem: ") == text.count("proven of the discrete")
    assert "Coulomb load factors of the discrete problem" in text


def test_blocks_alone_are_not_discretised():
    found = la.coulomb_range(block_slide(), restarts=0)
    assert found.scope is Scope.ITSELF
    assert found.continuum == found.bracket
    assert "discrete" not in str(found)
    assert "continuum" not in str(found)


def test_the_passive_wall_is_enclosed():
    """2 without friction, and 2.375 with; on a base that holds the soil where the wall begins."""
    found = la.bracket(passive_wall(0.2), 0.03, max_elements=1000)
    assert found.strict
    assert 1.99 < found.lower <= 2.0
    assert PASSIVE <= found.upper < 1.03 * PASSIVE
    assert "of every Coulomb load factor" in found.message
    smooth = la.bracket(passive_wall(la.SMOOTH), 0.03, max_elements=1000)
    assert smooth.status is la.Ending.REACHED
    assert smooth.lower <= 2.0 <= smooth.upper
    assert "Coulomb" not in smooth.message


def test_bounds_of_the_continuum_on_its_first_mesh():
    """The bounds themselves: 2 is what stress carries where nothing rubs, on any mesh."""
    found = continuum_range(la.discretise(passive_wall(0.2, 1)), "clarabel", {}, None)
    assert not found.missing
    assert found.lower == pytest.approx(2.0, rel=1e-6)  # its certificate's tolerance
    assert found.upper >= PASSIVE


@pytest.mark.slow
def test_the_passive_wall_on_its_first_mesh():
    """The frictionless value of the mesh lies above 2: no bound of the continuum."""
    found = la.coulomb_range(passive_wall(0.2, 2), restarts=0)
    assert found.bracket[0] > 2.001
    assert 1.95 < found.continuum[0] <= 2.0
    assert PASSIVE <= found.continuum[1] < np.inf


def test_messages_without_a_certificate_say_of_which_problem():
    for stated, words in (
        (footing(0.3), "every Coulomb load factor of the discrete problem is in ["),
        (block_slide(), "every Coulomb load factor is in ["),
    ):
        state = la.solve(stated, max_iterations=1, tolerance=1e-15)
        assert state.bracket is not None
        assert words in state.message


@pytest.mark.slow
def test_what_bounds_the_continuum_is_missing_by_name():
    """Straight edges in place of curves, an axisymmetric body, a point force."""
    straight = deformable_block(0.3)
    body = replace(straight.bodies["block"], geometry="approximated")
    found = la.coulomb_range(replace(straight, bodies={"block": body}), restarts=0)
    assert found.continuum == (-inf, inf)
    assert found.missing.count("straight edges") == 2
    pointed = replace(straight, dead_loads=[la.PointForce("block", (0, 1), (0, -0.1))])
    found = la.coulomb_range(pointed, restarts=0)
    assert found.continuum[0] == -inf
    assert found.continuum[1] < inf
    assert "no lower bound: " in found.missing
    assert "point force" in str(found)


def test_a_bracket_of_every_coulomb_load_factor():
    """Coulomb friction under a footing does not matter: both ends close on 2 + pi."""
    found = la.bracket(footing(0.3), 0.03)
    assert found.status is la.Ending.REACHED
    assert found.coulomb
    assert found.strict
    assert found.lower <= PRANDTL <= found.upper
    assert found.width <= 0.03
    assert not has_coulomb(found.lower_bound.model.problem)
    assert found.lower_bound.model.problem.interfaces[0].law == la.SMOOTH
    above = found.upper_bound.discretisation.problem.interfaces[0].law
    assert above == la.Coulomb(0.3, associated=True)
    # The gap is one of the associated problem: its own lower bound is above that without friction.
    assert found.gaps().least >= -1e-9
    assert not found.one_mesh
    assert "every Coulomb load factor" in heading(1, 2, 0.5, "reached", "every Coulomb load factor")
    with pytest.raises(la.InputError, match=r"meshes = 'shared'"):
        la.bracket(footing(0.3), 0.03, meshes="shared")


def test_a_bracket_that_friction_keeps_open_ends():
    """CLOSED_FORMS C14: nothing without friction, mu p b/h with it."""
    found = la.bracket(deformable_block(0.3), 0.01)
    assert found.status is la.Ending.SETTLED
    assert found.lower == pytest.approx(0, abs=1e-9)
    assert found.upper == pytest.approx(1.2, rel=1e-3)
    # Sliding alone is exact; "exact" is 1e-12 of what an upper bound may penetrate.
    assert found.upper >= 1.2 * (1 - 1e-12)
    assert found.history.elements.max() < 1000


def test_a_bracket_whose_lower_side_needs_friction():
    """Pushed by its dead load, and lifted: without friction nothing holds it.

    The upper end is refined all the same, to mu (W - alpha b) = H.
    """
    mesh = la.meshes.rectangle((0, 2), (0, 1), 4, 2)
    stated = la.Problem(
        {"block": la.Body(mesh, CRITERION)},
        [la.Traction("block", "top", (0, 1))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), 0.5)],
        dead_loads=[la.BodyForce("block", (0.1, -0.4))],
    )
    found = la.bracket(stated, 0.02)
    assert found.status in (la.Ending.SETTLED, la.Ending.NO_PROGRESS)
    assert found.lower == -inf
    assert "without Coulomb friction the dead loads collapse the structure" in found.failure
    assert found.upper == pytest.approx(0.2, rel=1e-3)
    assert found.upper >= 0.2 - 1e-12


@pytest.mark.slow
def test_prandtl_by_a_block_that_may_slide():
    found = la.coulomb_range(footing(0.3), restarts=0, target_width=0.0036)
    low, high = found.continuum
    assert 5.13 <= low <= PRANDTL <= high <= 5.16


def test_a_target_that_no_bracket_takes_is_refused():
    with pytest.raises(la.InputError, match="target_width"):
        la.coulomb_range(footing(0.3), target_width=0.0)
    assert np.isfinite(la.coulomb_range(block_slide(), restarts=0, target_width=0.1).high)
