"""What a load factor proves, by the kind of the problem and of the value."""

import pytest

import lacore as la
from lacore.reporting.status import Rigor, Scope
from tests.lacore.models import cantilever
from tests.rigid_problems import block_slide, box


def claimed(problem, rigor):
    d = la.discretise(problem)
    return d.scope, str(d.claim(rigor))


def block(friction):
    """A block on a floor whose friction is that of one law."""
    floor = la.Interface(("b", lambda x: x[1] == 0), la.RigidObstacle((0, 0), (0, 1)), friction)
    return la.Problem(
        {"b": la.RigidBlock(box(0, 1, 0, 1))},
        [la.BodyForce("b", (1, 0))],
        interfaces=[floor],
        dead_loads=[la.BodyForce("b", (0, -1))],
    )


@pytest.mark.parametrize("rigor", list(Rigor))
def test_of_a_mesh_the_rigour_says_it_all(rigor):
    scope, claim = claimed(cantilever(), rigor)
    assert scope is Scope.DISCRETE
    assert claim == str(rigor.claim)


def test_blocks_have_no_mesh():
    """Their load factor is exact with associated friction; by Coulomb friction it is not."""
    for rigor in (Rigor.UPPER, Rigor.LOWER, Rigor.DISCRETE):
        scope, claim = claimed(block(la.Coulomb(0.3, associated=True)), rigor)
        assert scope is Scope.ITSELF
        assert claim != str(rigor.claim)
        assert "exact" in claim
        assert "exact" not in claimed(block_slide(), rigor)[1]
    assert "strict upper bound of Coulomb" in claimed(block_slide(), Rigor.UPPER)[1]
    assert "certified Coulomb state" in claimed(block_slide(), Rigor.DISCRETE)[1]
    # What proves nothing proves nothing of blocks either.
    _, claim = claimed(block(la.Coulomb(0.3, associated=True)), Rigor.NOT_CERTIFIED)
    assert claim == str(Rigor.NOT_CERTIFIED.claim)
