"""Objects that print themselves, of small problems of every kind, status and coupling."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np

import lacore as la
from lacore.bounds.bracket.bracket import Ending as BracketEnding
from lacore.bounds.bracket.kept_water import Interpolated
from lacore.paths.path import Ending as PathEnding
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Rigor, Status
from tests.lacore.models import cantilever, deformable_block, punch, sheared, square
from tests.lacore.paths.path_billets import pressed, quad_billet

LONG = 'a name that somebody has made up of <b>html</b> & "quotes" ' * 200
TOLD = (Finding(Kind.BACKEND, values={"text": LONG}),)
MANY = tuple(f"block number {index}" for index in range(1000))


def wall(friction=0.65, push=(1, 0)):
    course = ([1, 1], [0.5, 1, 0.5])
    return la.Problem(
        bodies={"wall": la.masonry.running_bond(course, friction)},
        supports=[la.Fix("wall", "base")],
        reference_loads=[la.BodyForce("wall", push)],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )


def weak_pier():
    return la.Problem(
        bodies={"pier": la.masonry3d.wall([[1]], 0.5, crushing=la.Crushing(50.0, 1))},
        supports=[la.Fix("pier", "base")],
        reference_loads=[la.BodyForce("pier", (1, 0, 0))],
        dead_loads=[la.BodyForce("pier", (0, 0, -1))],
    )


def portal(foot="clamped"):
    frame = la.Frame(
        {"A": (0, 0), "B": (0, 3), "C": (4, 3), "D": (4, 0)},
        [("A", "B"), ("B", "C"), ("C", "D")],
        plastic_moment=10.0,
    )
    return la.Problem(
        bodies={"portal": frame},
        supports=[la.Fix("portal", "A", foot), la.Fix("portal", "D", foot)],
        reference_loads=[la.PointForce("portal", "B", (1, 0))],
    )


def mixed():
    """A block on soil beside a frame, and no name shorter than a page."""
    soil = la.Body(la.meshes.rectangle((-2, 2), (-1, 0), 4, 1), la.VonMises(100.0))
    stone = la.RigidBlock([(-1, 0), (1, 0), (1, 1), (-1, 1)])
    return la.Problem(
        bodies={LONG: stone, "soil": soil},
        reference_loads=[la.BodyForce(LONG, (1, 0))],
        supports=[la.Fix("soil", "bottom")],
        interfaces=[la.Interface((LONG, lambda x: x[1] == 0), ("soil", "top"), 0.4)],
        dead_loads=[la.BodyForce(LONG, (0, -1))],
    )


def locked():
    return la.Problem(
        bodies={"block": square()},
        supports=[la.Fix("block", "bottom"), la.Fix("block", "top")],
        reference_loads=[la.Pressure("block", "left"), la.Pressure("block", "right")],
    )


def unsafe():
    """A wall whose weight acts upwards: no push holds it."""
    return replace(wall(), dead_loads=[la.BodyForce("wall", (0, 1))])


def ring():
    mesh = la.meshes.isoparametric(la.meshes.rectangle((1, 2), (0, 1), 2, 2))
    body = la.Body(mesh, la.VonMises(1.0), kinematics="axisymmetric", space="p2-gauss")
    return la.Problem(
        bodies={"ring": body},
        supports=[la.Fix("ring", "bottom", "y"), la.Fix("ring", "top", "y")],
        reference_loads=[la.Pressure("ring", "left")],
    )


class Creep:
    """A law of a user, with a page of a repr."""

    def stress(self, strain):
        return np.ones_like(strain)

    def modulus(self, strain):
        return np.zeros_like(strain)

    def __repr__(self):
        return "Creep\n" * 1000


def values():
    """What is given to a problem, with the longest things that are taken."""
    wide = Fraction(10**300 + 1, 10**300)
    strains = np.linspace(0, 1, 1000)
    table = la.hardening.Table(strains, 1 + strains)
    plane = la.RigidObstacle(np.array([1 / 3, 1e-9]), [np.float64(1 / 3), -1])
    return [
        *(la.Fix("block", "left"), la.Fix(LONG, MANY, "normal")),
        *(la.Traction(LONG, MANY, (wide, 1)), la.Pressure(LONG, LONG, wide)),
        *(la.BodyForce(LONG, (10**50, 1), MANY), la.PointForce(LONG, LONG, (1, wide), LONG)),
        la.PiezometricLine([(number / 3, wide) for number in range(40)], 1 / 3),
        *(la.WaterTable(wide, 1 / 3), la.StandingWater(LONG, MANY, la.WaterTable(wide))),
        *(la.Within((-1 / 3, wide), 1 / 3), la.Along((1 / 3, 0), (wide, 1))),
        *(
            la.Beyond((1 / 3, 0), (wide, 1)),
            la.Linear(1 / 3, (wide, 1)),
            la.ByLevel(range(1000), range(1000)),
        ),
        *(la.PorePressure(LONG, np.full(1000, 1 / 3)), la.PorePressure(LONG, lambda x: x[0])),
        Interpolated(la.meshes.rectangle((0, 1), (0, 1), 1, 1), np.full(5, 1 / 3)),
        *(la.RigidFooting(LONG, lambda x: x[0] > 0, (0, -1), wide), plane, la.RigidObstacle()),
        la.RigidFooting(LONG, MANY, (0, 0, wide), wide, turning="xy", through=(wide, 1 / 3, 0)),
        la.Twist(LONG, MANY, (1 / 3, wide, 0), (wide, 0, 0), wide),
        *(
            la.Interface((LONG, MANY), (LONG[1:], MANY), la.Tresca(wide)),
            la.SMOOTH,
            la.STICK,
            la.BOND,
        ),
        *(la.Coulomb(wide, associated=True), la.Coulomb(1 / 3), la.VonMises(wide)),
        la.Coulomb(1 / 3, adhesion=wide, tension=wide),
        *(la.MohrCoulomb(wide, 30, tension_cutoff=0.0, crushing=wide), la.MaximumShear(wide)),
        la.MohrCoulomb(wide, 30, dilation_angle=1 / 3),
        *(la.Field(np.ones(400)), la.Field(lambda x: x[1], steepest=wide)),
        *(la.Rankine(wide, wide), la.NoTension(wide), la.DruckerPrager(wide, 30, "compression")),
        *(la.VonMises(hardening=table), la.VonMises(hardening=Creep()), table),
        *(la.hardening.Perfect(1.0), la.hardening.Linear(1.0, wide)),
        *(la.hardening.Voce(1.0, 2.0, 1 / 3), la.hardening.Swift(1.0, 1 / 3, 0.2)),
        *(la.AdaptiveSteps(1 / 3), la.LeastNorm(), la.Time(), la.FootingTravel()),
        *(la.Remeshing(size={LONG: 1 / 3}), la.Steady(1 / 3, wide)),
        *(la.ToolTravel({LONG: (1 / 3, wide), "b": (0, -1)}), la.Hook(print)),
        la.PathProgress(LONG, 1, wide, None, None, lambda: None, lambda: None),
        la.Tool(la.shapes.disc((1 / 3, wide), 1 / 3), (LONG, LONG), (1 / 3, wide)),
        *(la.PointTravel(LONG, (1 / 3, wide), (0, 1)), la.SolverProcess()),
        *(*drawn(), la.sections.Section(((-1 / 3, 0), (1 / 3, 0)), LONG)),
    ]


def drawn():
    """Two stones of a drawing whose words are all as long as can be."""
    blocks = la.BlockAssembly([la.masonry.rectangle(0, 1, y, y + 1) for y in (0, 1)], 0.5)
    solid = la.Polyhedron(
        1e10 / 3 * np.eye(4, 3), np.array([(0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    )
    wide = Fraction(10**300 + 1, 10**300)
    layer = la.masonry.Layer(la.Coulomb(wide), wide)
    layers = {LONG: layer, LONG[1:]: layer}
    of = dict.fromkeys(blocks.names, LONG)
    counts = dict.fromkeys(MANY, 10**50)
    drawing = la.masonry.DrawnBlocks(
        blocks, layers, of, of, LONG, "mm", 1 / 3, float(wide), counts, MANY
    )
    law = la.Crushing(wide, 1)
    solids = la.BlockAssembly3D(dict.fromkeys(MANY[:1], solid), la.Tresca(wide), crushing=law)
    return [layer, drawing, solid, solids, law]


def states():
    """Limit states of every body and coupling, of statuses that come about, and of all others."""
    found = [
        la.solve(punch(2, 2)),
        *(la.solve(deformable_block(0.3, space=space)) for space in ("p2-vertex", "p1-disc")),
        *(
            la.solve(deformable_block(0.3), backend)
            for backend in ("clarabel-regularised", "ipopt")
        ),
        la.solve(wall(), "highs"),
        *(la.solve(wall(), coupling=name) for name in ("certified", "reaction", "shift")),
        *(la.solve(wall(), coupling=name) for name in ("associated", "frictionless", "stick")),
        la.solve(wall(), coupling="reaction", max_iterations=1),
        la.solve(wall(), coupling="reaction", start="zero"),
        la.solve(portal()),
        la.solve(mixed()),
        la.solve(ring()),
        la.solve(locked()),
        la.solve(unsafe()),
        la.solve(punch(), options={"time_limit": 1e-9}),
    ]
    first = found[0]
    extreme = {"load_factor": -1.234567890123e-300, "solve_time": 1e9 / 3}
    other = [
        replace(
            first, status=status, rigor=rigor, findings=TOLD, bracket=(-np.inf, np.inf), **extreme
        )
        for status in Status
        for rigor in Rigor
    ]
    return found, [
        *other,
        replace(first, point=None, certificate=None, backend=LONG, coupling=LONG),
    ]


def answers():
    """To questions of engineers."""
    push, stone = [la.BodyForce("wall", (1, 0))], wall()
    cases = {LONG: push, "up": unsafe(), **dict.fromkeys("abcdefgh", push)}
    found = [
        la.load_cases(stone, cases),
        la.critical(lambda mu: wall(mu), (0.5, 0.7), target=0.6, tolerance=1e-3),
        la.worst_position(lambda mu: wall(mu), (0.5, 0.7), scan=3, tolerance=0.3),
        *(la.stable(own) for own in (stone, unsafe())),
    ]
    found += [la.sensitivity(la.solve(own)) for own in (portal(), wall())]
    sway = {"H": [la.PointForce("portal", "B", (1, 0))]}
    sway["V"] = [la.PointForce("portal", (2, 3), (0, -1))]
    found.append(la.envelope(portal(), sway, n=6))
    found += found[1].crossings
    return [*found, replace(found[1], status=la.Search.SAME_SIDE, of=LONG)]


@cache
def results():
    """What functions return: those that are made by solving, and those with other words in them."""
    found, other = states()
    made = [*found, punch(), mixed(), wall(), portal(), cantilever(), ring(), unsafe()]
    made += [body for problem in (punch(), mixed(), portal()) for body in problem.bodies.values()]
    made += [la.discretise(problem) for problem in (punch(2, 2), mixed(), portal())]
    for state in (found[0], found[5]):
        made += [state.certificate, state.interval(), state.interval().lower, state.stability()]
    made += [found[-3].ray, found[-2].ray, found[-2].stability()]
    below, above = la.lower_bound(punch(2, 2)), la.upper_bound(punch(2, 2))
    made += [below, above, la.lower_bound(locked()), la.upper_bound(locked())]
    gap = la.gap_identity(above, below)
    made += [
        la.safety_factor(punch(2, 2), tolerance=0.5),
        la.soil_range(sheared(0.0, cells=1), shares=(0.3,)),
    ]
    made += [gap, la.bracket(punch(2, 2), 0.2), la.bracket(locked(), 0.2)]
    made += [la.bracket(punch(2, 2), 0.01, max_elements=130, meshes="separate")]
    made += [la.bracket(deformable_block(0.3), 0.5, max_elements=100)]
    made += [la.coulomb_range(wall(), restarts=0), la.coulomb_range(unsafe(), restarts=0)]
    made.append(la.crushing_bracket(weak_pier(), rounds=1))
    made += [la.coulomb_range(deformable_block(0.3, b=1.0), restarts=0)]
    made += answers()
    arch = la.Problem(
        {"arch": la.masonry.arch(9, 1, 0.2, friction=0.9)},
        [la.BodyForce("arch", (1, 0))],
        [la.Fix("arch", ("left", "right"))],
        dead_loads=[la.BodyForce("arch", (0, -1))],
    )
    made += [la.thrust(arch, "arch", "right", (-1, 0)), la.solve(arch).carried]
    made += [pressed(steps=1), pressed(steps=1, billet=quad_billet)]
    path, spread = made[-2], next(own for own in made if isinstance(own, la.LoadFactorRange))
    bracket = next(own for own in reversed(made) if isinstance(own, la.Bracket))
    other += [replace(bracket, status=ending, failures=TOLD) for ending in BracketEnding]
    other += [replace(path, status=ending, findings=TOLD) for ending in PathEnding]
    nothing = path.history.iloc[:0], path.events.iloc[:0]
    other += [replace(path, history=nothing[0], events=nothing[1], last=None, settings={})]
    other += [
        replace(spread, findings=TOLD, unbounded=TOLD, backend=LONG, lowest=None, highest=None)
    ]
    other += [replace(gap, elements={}, bodies={}, interfaces=dict.fromkeys(MANY, 1 / 3))]
    return made, other


def inside(thing, seen=None):
    """All objects of lacore that an object holds, itself too, each once."""
    seen = {} if seen is None else seen
    if id(thing) in seen:
        return
    seen[id(thing)] = thing
    if type(thing).__module__.startswith("lacore") and not isinstance(thing, str):
        yield thing  # a text prints as itself
    if hasattr(thing, "items"):
        parts = [value for _, value in thing.items()]
    elif isinstance(thing, tuple | list):
        parts = thing
    else:
        parts = vars(thing).values() if type(thing).__module__.startswith("lacore") else ()
    for part in parts:
        yield from inside(part, seen)
