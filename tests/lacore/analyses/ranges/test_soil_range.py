"""The range of load factors of a soil: closed forms, and what injected searches prove."""

import time
from dataclasses import replace
from math import cos, radians, sin, tan
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.analyses.ranges import soil
from lacore.analyses.ranges.load_factors import RangeKind, about
from lacore.coupling.run import OutOfTime
from lacore.coupling.soil_search import SoilFound
from lacore.reporting.status import Status

PHI, COHESION, LATERAL = 30.0, 1.0, 0.5


def pressed(dilation=0.0):
    """A block between smooth platens, a pressure on its sides: the same stress everywhere."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=1, ny=1)
    own = la.MohrCoulomb(COHESION, PHI, dilation_angle=dilation)
    return la.Problem(
        bodies={"block": la.Body(mesh, own)},
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Traction("block", "top", (0, -1))],
        dead_loads=[la.Pressure("block", side, LATERAL) for side in ("left", "right")],
    )


def carried(cohesion, angle):
    """Vertical stress at which the block yields under its lateral pressure."""
    return (2 * cohesion * cos(angle) + LATERAL * (1 + sin(angle))) / (1 - sin(angle))


@pytest.fixture(scope="module")
def found():
    rows = []
    return la.soil_range(pressed(), shares=(1.0, 0.5), on_progress=rows.append), rows


def test_a_homogeneous_block_has_one_load_factor(found):
    own, _ = found
    exact = carried(COHESION, radians(PHI))
    assert own.status is Status.SOLVED
    assert own.kind is RangeKind.SOIL
    assert own.low <= own.high
    assert [own.low, own.high] == pytest.approx([exact, exact], rel=own.tolerance)
    assert [own.lowest.load_factor, own.highest.load_factor] == [own.low, own.high]
    assert own.bracket[0] - 1e-6 <= own.low <= own.high <= own.bracket[1] + 1e-6
    assert own.bracket[1] == pytest.approx(exact, rel=1e-6)
    assert own.highest_proven
    assert own.width == pytest.approx(0, abs=1e-4)
    assert own.stop is None


def test_the_load_factor_of_davis_is_that_of_reduced_strength(found):
    """Without dilation ``tan(phi_r) = beta tan(phi)`` and ``c_r = beta c``, beta = cos(phi)."""
    beta = cos(radians(PHI))
    angle = np.arctan(beta * tan(radians(PHI)))
    assert found[0].davis == pytest.approx(carried(beta * COHESION, angle), rel=1e-6)


def test_assembly_takes_a_part_of_the_time():
    begin = time.perf_counter()
    own = la.soil_range(pressed(), shares=(1.0,))
    spent = time.perf_counter() - begin
    for state in (own.lowest, own.highest):
        assert 0 < state.build_time < spent


def test_each_share_is_searched_twice(found):
    own, rows = found
    table = own.states
    assert table.to_dict("records") == rows
    assert table["share"].tolist() == [1.0, 1.0, 0.5, 0.5]
    assert table["search"].tolist() == ["settled", "drifted"] * 2
    assert (table["status"] == "certified").all()
    assert own.certified == 4
    assert own.solves == table["solves"].sum()
    assert (table["residual"] <= own.tolerance).all()
    assert (table["gap"].abs() <= table["residual"]).all()
    assert table["seconds"].is_monotonic_increasing
    assert own.settings == {"shares": (1.0, 0.5)}


@pytest.mark.parametrize(
    "given",
    [
        *({"shares": shares} for shares in ((), (0.0,), (1.1,), ("1",), (1.0, 1.1), (0.5, "1"))),
        {"tolerance": 0.0},
        {"time_limit": -1.0},
    ],
    ids=str,
)
def test_options_out_of_range_are_rejected(given):
    (name,) = given
    with pytest.raises(la.InputError, match=name):
        la.soil_range(pressed(), **given)


def test_associated_flow_has_no_range(monkeypatch):
    """It is rejected before any solve."""
    monkeypatch.setattr(soil, "_searched", None)
    with pytest.raises(la.InputError, match="flow of all bodies is associated"):
        la.soil_range(pressed(None))


def made_up(load_factor, point=True, certificate=True):
    """The end of a search at a load factor, with a state or none."""
    state = SimpleNamespace(load_factor=load_factor)
    proof = SimpleNamespace(worst=("gap", 1e-6), gap=1e-7) if certificate else None
    inner = SimpleNamespace(point=state if point else None, status=Status.LOCKED)
    final = SimpleNamespace(state=state if load_factor else None, certificate=proof)
    final = final if point else None
    return SoilFound(0.5, "settled", SimpleNamespace(inner=inner), (inner,) * 3, final)


@pytest.mark.parametrize(
    ("given", "status"),
    [
        (made_up(1.0), "certified"),
        (made_up(2.0), "certified"),
        (made_up(2.0 * (1 + 1e-7)), "certified"),  # round-off of two solves
        (made_up(2.0 * (1 + 1e-5)), "refused"),
        (made_up(1.0, certificate=False), "not certified"),
        (made_up(np.nan, point=False), "locked"),
        (made_up(None, certificate=False), "not certified"),  # its last solve has no state
    ],
)
def test_a_search_above_the_bound_of_all_load_factors_proves_nothing(given, status):
    """Load factors are in units of 10, and the bound is 20."""
    row = soil._row(given, 10.0, 20.0, 5.0)
    assert row["status"] == status
    exact = 10 * given.final.state.load_factor if status == "certified" else np.nan
    assert row["load_factor"] == pytest.approx(exact, nan_ok=True)
    assert (row["share"], row["search"], row["solves"], row["seconds"]) == (0.5, "settled", 3, 5.0)
    assert (
        np.isnan(row["residual"])
        == np.isnan(row["gap"])
        == (given.final is None or given.final.certificate is None)
    )


def searched(monkeypatch, problem, found=(), stops=False):
    """The range of a problem whose searches are given."""

    def states(run, shares):
        yield from found
        if stops:
            raise OutOfTime

    monkeypatch.setattr(soil, "soil_states", states)
    return la.soil_range(problem, shares=(1.0,))


def falling():
    """A slope that its own weight brings down."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(0.1, PHI, dilation_angle=0))},
        supports=[la.Fix("soil", "left"), la.Fix("soil", "bottom")],
        reference_loads=[la.Traction("soil", "top", (0, -1))],
        dead_loads=[la.BodyForce("soil", (0, -10.0))],
    )


def boxed():
    """A block without dilation, held on all sides but at its top, which is pressed: LOCKED."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
    own = la.MohrCoulomb(COHESION, PHI, dilation_angle=0)
    return la.Problem(
        bodies={"soil": la.Body(mesh, own)},
        supports=[la.Fix("soil", side, "normal") for side in ("left", "right", "bottom")],
        reference_loads=[la.Traction("soil", "top", (0, -1))],
    )


def test_without_a_state_the_range_tells_what_is_proven_instead(monkeypatch):
    none = searched(monkeypatch, pressed())
    assert none.status is Status.NOT_CERTIFIED
    assert np.isnan(none.low)
    assert np.isfinite(none.bracket).all()
    assert none.states.empty
    unsafe = searched(monkeypatch, falling())
    assert unsafe.status is Status.UNSAFE
    assert unsafe.bracket == (-np.inf, np.inf)
    assert unsafe.ray is not None
    locked = searched(monkeypatch, boxed())
    assert locked.status is Status.LOCKED
    assert locked.low == locked.high == np.inf


def test_searches_that_time_ends_prove_nothing(monkeypatch):
    stopped = searched(monkeypatch, pressed(), stops=True)
    assert stopped.status is Status.TIME_LIMIT
    assert stopped.stop.values == {"limit": 600.0, "done": 0, "every": 2}


def test_davis_needs_surfaces_that_slide():
    """Cones of axisymmetric soils are no planes of slip: Davis's strength is not defined."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=1, ny=1)
    own = la.DruckerPrager(1.0, PHI, "compression", dilation_angle=10.0)
    problem = la.Problem(
        bodies={"sample": la.Body(mesh, own, kinematics="axisymmetric", space="p2-gauss")},
        supports=[la.Fix("sample", "bottom", "y"), la.Fix("sample", "left", "x")],
        reference_loads=[la.RigidFooting("sample", "top", (0, -1), rough=False)],
    )
    assert np.isnan(soil._davis(la.discretise(problem), {}))


def test_the_width_is_relative_to_the_mean(found):
    assert replace(found[0], low=1.0, high=3.0).width == 1.0
    assert replace(found[0], low=2.0, high=3.0).width == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (1.0, 2.0, (1.0, 2.0)),
        (1 - 1e-7, 2 + 1e-7, (1 - 1e-7, 2 + 1e-7)),  # round-off widens the bounds
        (0.9, 2.2, (1.0, 2.0)),  # more than that is wrong, and stays visible
        (1.5, 1.6, (1.0, 2.0)),
    ],
)
def test_bounds_follow_certified_ends_by_round_off_only(low, high, expected):
    assert about((1.0, 2.0), low, high) == expected
