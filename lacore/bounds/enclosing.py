"""Two problems whose bounds enclose every Coulomb load factor of a problem (T14).

Soils with non-associated flow have no bounds and are rejected (T54).
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

from lacore.assembly.holding import slides_on_chords
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import require_linear
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.bodies.continuum.spaces import SPACES
from lacore.model.conditions.footings import footings
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.friction import Friction, friction_law
from lacore.model.problem.problem import Problem
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text


def has_coulomb(problem: Problem) -> bool:
    """Return whether there is non-associated Coulomb friction in interfaces or joints."""
    joints = (body.joints for body in of_kind(problem.bodies, BlockAssembly).values())
    return any(pair.law.terms().coefficient > 0 for pair in problem.interfaces) or any(
        bool((own.coefficient > 0).any()) for own in joints
    )


def frictionless(problem: Problem) -> Problem:
    """Return the problem without Coulomb friction, whose load factor is at most any Coulomb one."""

    def without(law: Friction) -> Friction:
        return law.frictionless() if law.terms().coefficient > 0 else law

    return _with_laws(problem, without)


def associated(problem: Problem) -> Problem:
    """Return the problem with associated friction.

    Its load factor is at least any Coulomb one.
    """
    return _with_laws(problem, lambda law: law.dilating())


def with_associated_flow(problem: Problem) -> Problem:
    """Return the problem with associated flow of soils; the admissible stresses are the same."""

    def normal(criterion: Criterion) -> Criterion:
        if getattr(criterion, "dilation_angle", None) is None:
            return criterion
        return replace(criterion, dilation_angle=None)  # type: ignore[type-var]

    soils = {}
    for name, body in of_kind(problem.bodies, Body).items():
        own = body.criterion
        flows = (
            {part: normal(one) for part, one in own.items()}
            if isinstance(own, Mapping)
            else normal(own)
        )
        soils[name] = replace(body, criterion=flows)
    return replace(problem, bodies={**problem.bodies, **soils})


def require_associated_flow(bodies: Mapping[str, Body]) -> None:
    """Raise `InputError` where the flow of a region of a body is not associated."""
    for name, body in bodies.items():
        for region in body.regions:
            if region.form.frictional:
                raise InputError(
                    named_criterion(name, region),
                    region.criterion.label,
                    "its flow is not associated, and the bound theorems do not hold with it",
                    text(
                        "an upper bound with its dilation_angle left out is one of all its load"
                        " factors, a lower one with friction_angle = dilation_angle and the"
                        " cohesion times tan(psi)/tan(phi) as well (T54), which without dilation"
                        " leaves no strength; {} looks for them",
                        terms.SOIL_RANGE,
                    ),
                )


def require_known_fields(problem: Problem) -> None:
    """Raise `InputError` where a strength or a body force varies in elements nobody knows how."""
    bodies = of_kind(problem.bodies, Body)
    for name, body in bodies.items():
        for region in body.regions:
            if not region.bounded:
                raise InputError(
                    named_criterion(name, region),
                    region.criterion.label,
                    "a strength that is not linear in each element: bounds have to know how far it"
                    " varies there",
                    text(
                        "{}let edges of the mesh follow jumps and bends, as {} does; or take {}",
                        Term(
                            "give lacore.Field(function, steepest=...), its largest slope per m; ",
                            "",
                        ),
                        terms.LAYERED,
                        terms.SOLVE,
                    ),
                )
    for field, load in problem.loads.items():
        if load.body in bodies:
            require_linear(load, bodies[load.body].mesh, field)


def require_chords(problem: Problem) -> None:
    """Raise `InputError` where velocities slide along an arc, across the chords of a mesh."""
    bodies = of_kind(problem.bodies, Body)
    for footing in footings(problem.loads.values()):
        body = bodies[footing.body]
        if SPACES[body.space].jumps or not slides_on_chords(footing, body):
            continue
        raise InputError(
            "RigidFooting.rough",
            False,
            f"in the space {body.space!r} velocities slide along the arc that the edges of the mesh"
            " replace, and bound no load factor",
            "take the space 'p2-disc', whose velocities slide along the edges",
        )


def named_criterion(body: str, region: Region) -> str:
    """Return a criterion for messages, as ``Problem.bodies['soil'].criterion['clay']``."""
    part = f"[{region.name!r}]" if region.name else ""
    return f"Problem.bodies[{body!r}].criterion{part}"


def _with_laws(problem: Problem, changed: Callable[[Friction], Friction]) -> Problem:
    if not has_coulomb(problem):
        return problem
    blocks = {
        name: replace(
            body,
            friction=changed(friction_law(body.friction, "BlockAssembly.friction")),
            joint_friction={
                pair: changed(friction_law(law, "BlockAssembly.joint_friction"))
                for pair, law in (body.joint_friction or {}).items()
            },
        )
        for name, body in of_kind(problem.bodies, BlockAssembly).items()
    }
    pairs = [replace(pair, friction=changed(pair.law)) for pair in problem.interfaces]
    return replace(problem, bodies={**problem.bodies, **blocks}, interfaces=pairs)
