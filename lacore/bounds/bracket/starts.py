"""Problems and meshes from which a bracket starts (T26d)."""

from dataclasses import dataclass

import numpy as np
from skfem import MeshTri

from lacore.assembly.discretise import discretise
from lacore.bounds.bracket.kept_water import differs
from lacore.bounds.bracket.same_domain import difference
from lacore.bounds.bracket.singular_points import friction_of, sectors_for, singular_vertices
from lacore.bounds.bracket.whole import (
    continua,
    elements,
    in_bounding_spaces,
    mesh_of,
    on_mesh,
    with_jumps,
    with_kept_water,
)
from lacore.bounds.constants import SLIVER
from lacore.bounds.enclosing import associated, frictionless, has_coulomb
from lacore.bounds.static_corners import CornerError
from lacore.bounds.static_model import static_model
from lacore.model.conditions.elimination import HeldFootingError
from lacore.model.meshes.checks import quality
from lacore.model.meshes.fans import fanned
from lacore.model.meshes.structured import split
from lacore.model.problem.matching import matching
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, require_known

MESHES = ("separate", "shared")


@dataclass(frozen=True)
class Start:
    """Problem on its first mesh, and the bounds to compute on it: ``lower``, ``upper`` or both."""

    kinds: tuple[str, ...]
    problem: Problem


def starts(
    problem: Problem,
    target_width: float,
    max_elements: int,
    meshes: str | None,
    lower_mesh: MeshTri | None,
) -> list[Start]:
    """Return the first meshes; the arguments are those of `lacore.bracket`."""
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
    bodies = continua(problem)
    problem = matching(with_kept_water(problem))
    problem = _movable(in_bounding_spaces(on_mesh(problem, mesh_of(problem))))
    rubbed = max(friction_of(body) for body in bodies.values())
    solid = any(body.dimension == 3 for body in bodies.values())
    if meshes is None:
        fans = solid or (rubbed > 0 and bool(singular_vertices(problem)))
        apart = coulomb or lower_mesh is not None or fans
        meshes = "separate" if apart else "shared"
    if meshes == "shared":
        both = _statable(problem)
        _check("both bounds", mesh_of(both), max_elements)
        return [Start(("lower", "upper"), both)]
    above, below = associated(problem), frictionless(problem)
    _check("the upper bound", mesh_of(above), max_elements)
    if lower_mesh is None and not solid:
        sectors = sectors_for(target_width, rubbed)
        below = on_mesh(below, fanned(mesh_of(below), singular_vertices(below), sectors))
    elif lower_mesh is not None:
        below = _given(below, lower_mesh)
    below = _statable(below)
    _check("the lower bound", mesh_of(below), max_elements)
    return [Start(("lower",), below), Start(("upper",), above)]


def _movable(problem: Problem) -> Problem:
    """Return the problem with discontinuous velocities if continuous ones would fix a footing."""
    try:
        discretise(problem)
    except HeldFootingError:
        return with_jumps(problem)
    return problem


def _given(problem: Problem, lower_mesh: MeshTri) -> Problem:
    """Return the problem on a mesh of the user, which must be one of the same domain."""
    if type(lower_mesh) is not MeshTri:
        raise InputError(
            "lower_mesh",
            type(lower_mesh).__name__,
            "not a mesh of straight-edged triangles",
            "give a skfem.MeshTri, such as a lacore.model.meshes.fan",
        )
    name, *others = continua(problem)
    if others:
        raise InputError(
            "lower_mesh",
            f"mesh of {lower_mesh.nelements} elements",
            f"one mesh, and the problem has the bodies {[name, *others]}",
            "leave it out; meshes='separate' puts fans at singular points",
        )
    below = on_mesh(problem, lower_mesh)
    body, other = continua(problem)[name], continua(below)[name]
    why = difference(body, other)
    if why:
        raise InputError(
            "lower_mesh",
            f"mesh of {lower_mesh.nelements} elements",
            f"covers another domain: {why}; a lower bound there is none of this problem",
            "mesh the same outline, with the same names of its parts",
        )
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
    """Return the problem with elements split where loads need two shear stresses at a corner."""
    for _ in continua(problem):
        try:
            static_model(problem)
        except CornerError as error:
            mesh = mesh_of(problem)
            wrong = elements(problem, mesh, error.body)[error.elements]
            problem = on_mesh(problem, split(mesh, wrong.tolist()))
        else:
            break
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
    if shape[worst] < SLIVER:
        raise InputError(
            f"mesh of {whose}",
            None,
            f"element {worst} is a sliver of shape {shape[worst]:.2g} (1 is equilateral), below"
            f" {SLIVER}",
            "move its vertices, or mesh with larger angles",
        )
