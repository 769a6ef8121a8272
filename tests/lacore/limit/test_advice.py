"""What a state without a load factor reports on bodies without strength."""

import re

import pytest

import lacore as la
from lacore.limit.judges.judging import strengthless_bodies
from lacore.reporting.status import Status


def masonry(criterion):
    """Half of a round footing on a block that is pressed beside it."""
    mesh = la.meshes.quadrilaterals(x=(0, 3), y=(-1.5, 0), nx=6, ny=3)
    body = la.Body(mesh, criterion, "axisymmetric", "q2")
    beside = la.Pressure("base", lambda x: (x[1] == 0) & (x[0] >= 1), 1e4)
    return la.Problem(
        {"base": body},
        [la.RigidFooting("base", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), pressure=1e3)],
        [la.Fix("base", "bottom"), la.Fix("base", "right")],
        dead_loads=[la.BodyForce("base", (0, -18e3)), beside],
    )


def told(state, status):
    """What is reported of bodies without strength, if the status of a state were another."""
    return "; ".join(map(str, strengthless_bodies(state, status)))


@pytest.mark.parametrize("status", [Status.NOT_CERTIFIED, Status.STALLED, Status.ITERATION_LIMIT])
def test_where_no_load_factor_is_found_it_says_what_to_lend(status):
    """Whichever solver ends so: with what is lent there is one, and it rises by no digit of it."""
    none = la.solve(masonry(la.NoTension(1e5)))
    message = told(none, status)
    lent = re.search(r"'base' has no strength without .* tensile strength, (\S+) Pa", message)
    little, more = (
        la.solve(masonry(la.Rankine(times * float(lent[1]), 1e5)), throw=True) for times in (1, 3)
    )
    assert little.load_factor < more.load_factor < (1 + 1e-5) * little.load_factor
    some = told(little, status)
    assert "lend" not in some
