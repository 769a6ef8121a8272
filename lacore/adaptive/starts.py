"""What a bracket starts from: which problems, on which meshes (T26d)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from skfem import MeshTri

from lacore.adaptive.kept_water import differs, kept
from lacore.adaptive.same_domain import difference
from lacore.adaptive.singular_points import friction_of, sectors_for, singular_points
from lacore.bodies.any_body import of_kind
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.spaces import BOUNDING
from lacore.bounds.enclosing import associated, frictionless, has_coulomb
from lacore.bounds.static_corners import CornerError
from lacore.bounds.static_model import static_model
from lacore.conditions.loads import Load
from lacore.errors import InputError, require_known
from lacore.meshes.checks import quality
from lacore.meshes.fans import fanned
from lacore.meshes.structured import split
from lacore.problem.problem import Problem

MESHES = ("separate", "shared")
_SLIVER = 0.01  # shape of a triangle; below it strain rates lose their digits


@dataclass(frozen=True)
class Start:
    """A problem on its first mesh, and which bounds of it count: ``lower``, ``upper`` or both."""

    kinds: tuple[str, ...]
    problem: Problem


def starts(
    problem: Problem,
    target_width: float,
    max_elements: int,
    meshes: str | None,
    lower_mesh: MeshTri | None,
) -> list[Start]:
    """The first meshes: arguments as of `lacore.bracket`."""
    if meshes is not None:
        require_known("meshes", meshes, MESHES)
    if lower_mesh is not None and meshes == "shared":
        raise InputError(
            "lower_mesh", None, "there is one mesh only", "give it as that of the problem"
        )
    coulomb = has_coulomb(problem)
    if coulomb and meshes == "shared":
        raise InputError(
            "meshes",
            meshes,
            "Coulomb friction: the lower bound is one without friction, the upper one that of"
            " associated friction, two problems whose errors lie elsewhere",
            "leave it out",
        )
    if meshes is None:
        name, body = only_body(problem)
        fans = friction_of(body) > 0 and bool(singular_points(problem, name))
        apart = coulomb or lower_mesh is not None or fans
        meshes = "separate" if apart else "shared"
    problem = with_kept_water(on_mesh(problem, mesh_of(problem)))
    if meshes == "shared":
        both = _statable(problem)
        _check("both bounds", mesh_of(both), max_elements)
        return [Start(("lower", "upper"), both)]
    above, below = associated(problem), frictionless(problem)
    _check("the upper bound", mesh_of(above), max_elements)
    if lower_mesh is None:
        name, body = only_body(below)
        sectors = sectors_for(target_width, friction_of(body))
        below = on_mesh(below, fanned(mesh_of(below), singular_points(below, name), sectors))
    else:
        below = _given(below, lower_mesh)
    below = _statable(below)
    _check("the lower bound", mesh_of(below), max_elements)
    return [Start(("lower",), below), Start(("upper",), above)]


def only_body(problem: Problem) -> tuple[str, Body]:
    """Name of the body whose mesh is refined, and that body; rigid blocks have no mesh."""
    rigid = of_kind(problem.bodies, BlockAssembly)
    meshed = {name: body for name, body in problem.bodies.items() if name not in rigid}
    if not meshed:
        raise InputError(
            "Problem.bodies",
            list(problem.bodies),
            "a bracket refines the mesh of one body, and rigid blocks have none",
            "take lacore.solve or coulomb_range: of rigid blocks alone there is nothing to refine",
        )
    if len(meshed) > 1:
        raise InputError(
            "Problem.bodies",
            list(meshed),
            "a bracket refines the mesh of one body, and meshes must match where bodies meet",
            "refine by hand, with lacore.lower_bound and lacore.upper_bound",
        )
    ((name, stated),) = meshed.items()
    body = of_kind(meshed, Body).get(name)
    if body is None or type(body.mesh) is not MeshTri:
        raise InputError(
            f"Problem.bodies[{name!r}]",
            type(stated if body is None else body.mesh).__name__,
            "a bracket takes a deformable body on straight-edged triangles",
            "give a lacore.Body on a skfem.MeshTri",
        )
    if body.axisymmetric:
        raise InputError(
            f"Problem.bodies[{name!r}].kinematics",
            body.kinematics,
            "nothing is a strict bound of a body of revolution",
            "take `solve`, whose value converges under refinement",
        )
    return name, body


def on_mesh(problem: Problem, mesh: MeshTri) -> Problem:
    """The problem with its body on another mesh, in the velocity space of upper bounds.

    What is projected from ``p2-gauss`` is a little closer, and astray where mechanisms are not
    unique.
    """
    name, body = only_body(problem)
    finer = replace(body, mesh=mesh, space=BOUNDING)
    return replace(problem, bodies={**problem.bodies, name: finer})


def with_kept_water(problem: Problem) -> Problem:
    """The problem with the water that it has on its mesh, whatever mesh comes next."""
    name, body = only_body(problem)

    def held(loads: Sequence[Load]) -> list[Load]:
        return [kept(load, body) if load.body == name else load for load in loads]

    return replace(
        problem,
        reference_loads=held(problem.reference_loads),
        dead_loads=held(problem.dead_loads),
    )


def mesh_of(problem: Problem) -> MeshTri:
    """The mesh that is refined."""
    return only_body(problem)[1].mesh


def _given(problem: Problem, lower_mesh: MeshTri) -> Problem:
    """The problem on a mesh of the user, which must be one of the same domain."""
    if type(lower_mesh) is not MeshTri:
        raise InputError(
            "lower_mesh",
            type(lower_mesh).__name__,
            "not a mesh of straight-edged triangles",
            "give a skfem.MeshTri, such as a lacore.meshes.fan",
        )
    below = on_mesh(problem, lower_mesh)
    why = difference(only_body(problem)[1], only_body(below)[1])
    if why:
        raise InputError(
            "lower_mesh",
            f"mesh of {lower_mesh.nelements} elements",
            f"covers another domain: {why}; a lower bound there is none of this problem",
            "mesh the same outline, with the same names of its parts",
        )
    (name, body), (_, other) = only_body(problem), only_body(below)
    for field, load in problem.loads.items():
        if load.body == name and differs(load, body, other):
            raise InputError(
                "lower_mesh",
                f"mesh of {lower_mesh.nelements} elements",
                f"has other water between its vertices than the problem's: {field}",
                "let edges of both follow the water table, or leave it out",
            )
    return below


def _statable(problem: Problem) -> Problem:
    """With elements split at whose corners loads ask for two shear stresses in one place."""
    try:
        static_model(problem)
    except CornerError as error:
        return on_mesh(problem, split(mesh_of(problem), error.elements))
    return problem


def _check(whose: str, mesh: MeshTri, max_elements: int) -> None:
    if mesh.nelements > max_elements:
        raise InputError(
            "max_elements",
            max_elements,
            f"the mesh of {whose} starts with {mesh.nelements} elements",
            "raise it, or start coarser",
        )
    shape = quality(mesh)
    worst = int(np.argmin(shape))
    if shape[worst] < _SLIVER:
        raise InputError(
            f"mesh of {whose}",
            None,
            f"element {worst} is a sliver of shape {shape[worst]:.2g} (1 is equilateral), below"
            f" {_SLIVER}",
            "move its vertices, or mesh with larger angles",
        )
