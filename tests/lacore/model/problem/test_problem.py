"""What cannot be right is refused when it is stated, with field, value and fix."""

import numpy as np
import pytest

import lacore as la
from lacore.reporting.errors import suggest
from tests.lacore.models import CRITERION, obstacle, square

PUSH = la.Traction("block", "left", (1, 0))
HOLD = la.Fix("block", "bottom")


def problem(**given):
    arguments = {"bodies": {"block": square()}, "reference_loads": [PUSH], **given}
    return la.Problem(**arguments)


def refuses(statement, *parts):
    with pytest.raises(la.InputError) as caught:
        statement()
    message = str(caught.value)
    assert all(part in message for part in parts), message


def test_loads_of_zero_are_none():
    """As a surcharge of a series that begins with none; nothing of them is drawn."""
    nothing = [
        la.Pressure("block", "top", 0.0),
        la.Traction("block", "top", (0, 0)),
        la.BodyForce("block", (0.0, 0.0)),
        la.PointForce("block", (0, 1), (0, 0)),
    ]
    plain = problem(supports=[HOLD])
    load_factor, texts = la.solve(plain).load_factor, len(plain.plot().axes[0].texts)
    idle = [problem(supports=[HOLD], dead_loads=[load]) for load in nothing]
    idle += [problem(supports=[HOLD], reference_loads=[PUSH, load]) for load in nothing]
    for stated in idle:
        assert la.solve(stated).load_factor == load_factor, stated
    for stated in (
        problem(supports=[HOLD], dead_loads=nothing),
        problem(supports=[HOLD], reference_loads=[PUSH, *nothing]),
    ):
        assert len(stated.plot().axes[0].texts) == texts, stated
    assert la.lower_bound(problem(supports=[HOLD], dead_loads=nothing[:1]), throw=True)


def test_the_sound_one_is_taken():
    problem(supports=[HOLD], interfaces=[obstacle("right")])


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        ({"bodies": {}}, ("Problem.bodies", "there is none", "bodies={")),
        ({"bodies": {"block": "steel"}}, ("Problem.bodies['block'] = 'steel'", "lacore.Body")),
        ({"bodies": {1: "steel"}}, ("Problem.bodies = 1", "not a name", "give a text")),
        (
            {"reference_loads": [la.Pressure("block", "top", 0), la.BodyForce("block", (0, 0))]},
            ("Problem.reference_loads = 'pressure 0 Pa on block.top'", "is zero", "that is not"),
        ),
        ({"reference_loads": [HOLD]}, ("Problem.reference_loads[0]", "lacore.Traction")),
        ({"dead_loads": [PUSH, 9.81]}, ("Problem.dead_loads[1] = 9.81", "not a load")),
        (
            {"reference_loads": [la.Twist("block", "top", (0, 0, 1))]},
            ("Problem.reference_loads[0] = 'Twist'", "an axis in three dimensions", "another load"),
        ),
        (
            {"reference_loads": [la.Traction("blok", "left", (1, 0))]},
            ("Problem.reference_loads[0].body = 'blok'", "did you mean 'block'?"),
        ),
        (
            {"reference_loads": [la.Traction("block", "lfet", (1, 0))]},
            ("Problem.reference_loads[0].where = 'lfet'", "did you mean 'left'?"),
        ),
        (
            {"dead_loads": [la.BodyForce("soil", (0, -1))]},
            ("Problem.dead_loads[0].body = 'soil'", "known names: block"),
        ),
        (
            {"reference_loads": [la.PointForce("block", (0.4, 1.0), (0, -1))]},
            ("reference_loads[0].at = (0.4, 1.0)", "no vertex", "(0.5, 1.0)"),
        ),
        ({"supports": [PUSH]}, ("Problem.supports[0]", "lacore.Fix")),
        (
            {"supports": [HOLD, la.Fix("block", "botom")]},
            ("Problem.supports[1].where = 'botom'", "did you mean 'bottom'?"),
        ),
        ({"supports": [la.Fix("rock", "bottom")]}, ("Problem.supports[0].body = 'rock'",)),
        (
            {"supports": [la.Fix("block", lambda x: x[0] < -7)]},
            ("Problem.supports[0].where", "an empty boundary"),
        ),
        ({"interfaces": [HOLD]}, ("Problem.interfaces[0]", "lacore.Interface")),
        ({"interfaces": [obstacle(body="b")]}, ("Problem.interfaces[0].slave.body = 'b'",)),
        (
            {"interfaces": [obstacle("bottm")]},
            ("Problem.interfaces[0].slave = 'bottm'", "did you mean 'bottom'?"),
        ),
    ],
)
def test_problem(given, parts):
    refuses(lambda: problem(**given), *parts)


def test_a_problem_without_loads_is_for_tools_alone():
    stated = problem(reference_loads=[], supports=[HOLD])
    refuses(lambda: la.solve(stated), "Problem.reference_loads", "at least one load", "tools")


def test_interface_given_twice():
    refuses(
        lambda: problem(interfaces=[obstacle("bottom"), obstacle(lambda x: x[1] == 0)]),
        "Problem.interfaces[1]",
        "shares boundary edges with Problem.interfaces[0]",
        "one interface",
    )


def plane(point, normal):
    return la.Interface(("block", "bottom"), la.RigidObstacle(point, normal), 0.3)


@pytest.mark.parametrize(("height", "word"), [(-0.01, "above"), (0.02, "inside")])
def test_interface_that_does_not_touch(height, word):
    refuses(
        lambda: problem(interfaces=[plane((0.0, height), (0.0, 1.0))]),
        "Problem.interfaces[0] = 'block.bottom'",
        "does not touch its obstacle",
        f"{abs(height):.3g} m {word}",
        "move the body or RigidObstacle.point",
    )


def test_interface_that_touches_at_one_end_only():
    refuses(lambda: problem(interfaces=[plane((0, 0), (-0.1, 1.0))]), "does not touch")


def test_obstacle_turned_inside_out():
    refuses(
        lambda: problem(interfaces=[plane((0, 0), (0, -1))]),
        "Problem.interfaces[0].master.normal",
        "from the obstacle into the body",
    )


def test_obstacle_that_touches():
    problem(interfaces=[plane((-3.0, 0.0), (0.0, 0.5))])


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        (lambda: la.Coulomb(-0.1), ("friction = -0.1", "mu >= 0")),
        (lambda: la.Coulomb(np.nan), ("friction = nan", "not a friction coefficient")),
        (lambda: la.Coulomb(np.inf), ("friction = inf", "lacore.STICK (no slip)")),
        (lambda: obstacle(friction=-1), ("friction = -1", "mu >= 0")),
        (lambda: obstacle(friction=np.nan), ("friction = nan",)),
        (lambda: obstacle(friction="0.3"), ("Interface.friction = '0.3'", "lacore.Coulomb")),
        (lambda: obstacle(friction=None), ("Interface.friction: not a friction law",)),
        (lambda: la.Tresca(-1.0), ("Tresca.limit = -1.0", "stress >= 0 in Pa")),
        (lambda: la.Tresca(np.nan), ("Tresca.limit = nan",)),
        (lambda: la.Interface("block", la.RigidObstacle(), 0), ("Interface.slave = 'block'",)),
        (
            lambda: la.Interface(("a", "top"), "b", 0.1),
            ("Interface.master = 'b'", "not an obstacle", "RigidObstacle()"),
        ),
        (
            lambda: problem(interfaces=[la.Interface(("block", "top"), ("block", "left"), 0.1)]),
            ("interfaces[0].master = 'block'", "in contact with itself", "`approaching`"),
        ),
        (lambda: la.RigidObstacle(point=(0, 0)), ("RigidObstacle", "both or none")),
        (lambda: la.RigidObstacle((0, 0), (0, 0)), ("RigidObstacle.normal", "vector != 0")),
        (lambda: la.RigidObstacle((0, np.nan), (0, 1)), ("RigidObstacle", "point=(x, y)")),
        (
            lambda: la.Fix("a", "top", "w"),
            ("Fix.components = 'w'", "known names: all, clamped, normal"),
        ),
        (lambda: la.Fix("a", "top", "norml"), ("did you mean 'normal'?",)),
        (lambda: la.Traction("a", "top", (0, np.nan)), ("Traction.vector", "finite", "Pa")),
        (lambda: la.Traction("a", "top", (1, 2, 3, 4)), ("Traction.vector", "two")),
        (lambda: la.BodyForce("a", (0, np.inf)), ("BodyForce.vector", "N/m^3")),
        (lambda: la.Pressure("a", "top", np.nan), ("Pressure.value = nan",)),
        (lambda: la.PointForce("a", (0,), (1, 0)), ("PointForce.at", "give (x, y)")),
        (lambda: la.RigidFooting("a", "top", (0, 0)), ("RigidFooting.direction", "zero")),
        (lambda: la.RigidFooting("a", "top", (0, 1), np.inf), ("RigidFooting.pressure = inf",)),
    ],
)
def test_parts(statement, parts):
    refuses(statement, *parts)


def test_load_where_supports_hold_everything():
    refuses(
        lambda: la.discretise(problem(supports=[la.Fix("block", "left")])),
        "Problem.reference_loads",
        "they do no power (F0 = 0)",
        "load a boundary that can move",
    )


def test_load_whose_direction_supports_hold():
    refuses(
        lambda: la.discretise(problem(supports=[la.Fix("block", "left", "x")])),
        "they do no power (F0 = 0)",
    )


def test_loads_that_cancel():
    refuses(
        lambda: la.discretise(
            problem(reference_loads=[PUSH, la.Traction("block", "left", (-1.0, 0.0))])
        ),
        "F0 = 0",
    )


def test_footing_edge_on_a_midside_node():
    # Vertices of the top edge are 0, 0.5 and 1: 0.25 is the midside node of the first edge.
    refuses(
        lambda: problem(
            reference_loads=[
                la.RigidFooting("block", lambda x: (x[1] == 1) & (x[0] <= 0.25), (0, -1))
            ]
        ),
        "Problem.reference_loads[0].where",
        "at a midside node",
        "put a vertex of the mesh where it ends",
    )


def test_footing_that_a_support_holds():
    """Straight triangles in the plane would slip past the support; here they push against it."""
    refuses(
        lambda: la.discretise(
            problem(
                supports=[la.Fix("block", "top")],
                reference_loads=[la.RigidFooting("block", "top", (0, -1))],
            )
        ),
        "RigidFooting = 'block: top'",
        "keeps it from moving",
        "let the other one end before it",
    )


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        ({"backend": "clarabell"}, ("backend = 'clarabell'", "did you mean 'clarabel'?")),
        ({"coupling": "reactio"}, ("coupling = 'reactio'", "did you mean 'reaction'?")),
        ({"start": "zeros"}, ("start = 'zeros'", "did you mean 'zero'?")),
        ({"damping": 0.0}, ("damping = 0.0", "(0, 1]")),
        ({"damping": np.nan}, ("damping = nan",)),
        ({"anderson": -1}, ("anderson = -1", "0 for none")),
        ({"tolerance": -1e-6}, ("tolerance = -1e-06", "> 0")),
        ({"tolerance": np.nan}, ("tolerance = nan",)),
        ({"max_iterations": 0}, ("max_iterations = 0", "> 0")),
        ({"options": {"tolerence": 1e-9}}, ("'auto'", "did you mean 'tolerance'?")),
        ({"options": {"tolerance": -1.0}}, ("auto.tolerance = -1.0",)),
    ],
)
def test_solve_refuses_before_any_solve(given, parts):
    refuses(lambda: la.solve(problem(supports=[HOLD]), **given), *parts)


def test_a_problem_is_immutable():
    bodies = {"block": square()}
    stated = problem(bodies=bodies)
    bodies.clear()
    assert list(stated.bodies) == ["block"]
    with pytest.raises(TypeError):
        stated.bodies["other"] = square()
    with pytest.raises(AttributeError):
        stated.supports = ()
    assert stated.reference_loads == (PUSH,)


def test_suggest():
    assert suggest("lef", ["left", "right"]) == "did you mean 'left'?"
    assert suggest("zz", ["b", "a"]) == "known names: a, b"
    assert suggest("zz", []) == "none is known"


def test_input_error_is_a_value_error_with_its_parts():
    with pytest.raises(ValueError, match="friction") as caught:
        la.Coulomb(-1.0)
    assert (caught.value.field, caught.value.value) == ("friction", -1.0)
    assert isinstance(caught.value, la.LacoreError)
    assert CRITERION.k == 1


@pytest.mark.parametrize(
    "make",
    [
        lambda: la.VonMises(shear_strength="1"),
        lambda: la.VonMises(yield_stress=True),
        lambda: la.Coulomb("rough"),
        lambda: la.Tresca("1"),
        lambda: la.Pressure("block", "top", "1"),
        lambda: la.Traction("block", "top", ("a", 1)),
        lambda: la.Traction("block", "top", 5),
        lambda: la.PointForce("block", 3, (1, 2)),
        lambda: la.RigidObstacle((0,), (1, 2)),
        lambda: la.Interface(("block", "top"), la.RigidObstacle(), True),
    ],
)
def test_what_is_not_a_number_is_an_input_error(make):
    with pytest.raises(la.InputError, match="; "):
        make()


def _guided(components):
    """Of a space that slips along no support."""
    mesh = la.meshes.quadrilaterals((0, 1), (0, 1), 3, 3)
    return la.Problem(
        bodies={"block": la.Body(mesh, CRITERION, space="q2")},
        supports=[la.Fix("block", "right", components)],
        interfaces=[obstacle()],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Pressure("block", "top", 0.5)],
    )


def test_friction_where_a_support_takes_the_normal_force():
    """The contact reaction would be anything, and the load factor with it."""
    named = r"'block.bottom': a support holds .*\[1. 0.\].*before the interface"
    with pytest.raises(la.InputError, match=named):
        la.discretise(_guided("y"))


def test_contact_points_that_a_support_holds_are_left_out():
    """Nothing there moves, so it is the support that carries; 7 control values less one."""
    assert len(la.solve(_guided("xy"), throw=True).reactions) == 6
