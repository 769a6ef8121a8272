"""Bodies of a problem as one mesh, in which both sides of interfaces are refined together.

Its elements are those of the bodies, one body after the other.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from skfem import MeshTet, MeshTri

from lacore.assembly.holding import slides_on_chords
from lacore.assembly.loading import footings_of
from lacore.bounds.bracket.kept_water import kept
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.regions import inheriting
from lacore.model.bodies.continuum.spaces import BOUNDING
from lacore.model.conditions.loads import Load
from lacore.model.meshes.joined import Joined, elements_of, joined, parted
from lacore.model.problem.matching import glued
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text

_OPENING = {"normal", "xyz"}  # supports along which soil slips, or from which it separates


def continua(problem: Problem) -> dict[str, Body]:
    """Return the bodies whose meshes are refined; rigid blocks have none.

    Raises:
        InputError: there is none, or one without strict bounds.
    """
    rigid = of_kind(problem.bodies, BlockAssembly)
    meshed = {name: body for name, body in problem.bodies.items() if name not in rigid}
    if not meshed:
        raise InputError(
            "Problem.bodies",
            list(problem.bodies),
            "a bracket refines the meshes of deformable bodies, and rigid blocks have none",
            text(
                "take {} or {}: of rigid blocks alone there is nothing to refine",
                Term("lacore.solve", "`lacore solve` without --bracket"),
                Term("coulomb_range", "--range"),
            ),
        )
    deforming = of_kind(meshed, Body)
    for name, stated in meshed.items():
        body = deforming.get(name)
        if body is None or type(body.mesh) not in (MeshTri, MeshTet):
            raise InputError(
                f"Problem.bodies[{name!r}]",
                type(stated if body is None else body.mesh).__name__,
                "a bracket takes deformable bodies on straight-edged triangles, or tetrahedra",
                text(
                    "give a {}",
                    Term(
                        "lacore.Body on a skfem.MeshTri, or a MeshTet",
                        'body of kind "continuum", not of q2',
                    ),
                ),
            )
        if body.dimension == 3 and len(meshed) > 1:
            raise InputError(
                "Problem.bodies",
                list(meshed),
                "a bracket takes one body of tetrahedra",
                "make a problem of each: they do not touch",
            )
        if body.axisymmetric:
            raise InputError(
                f"Problem.bodies[{name!r}].kinematics",
                body.kinematics,
                "there are no strict bounds of axisymmetric bodies",
                text("take {}, whose value converges under refinement", terms.SOLVE),
            )
    return deforming


def whole(problem: Problem, *, bonded: bool = False) -> Joined:
    """Return the matching meshes of its bodies as one.

    With `bonded`, vertices are shared only where bodies are bonded.
    """
    meshes = {name: body.mesh for name, body in continua(problem).items()}
    return joined(meshes, glued(problem, bonded))


def mesh_of(problem: Problem) -> MeshTri:
    """Return the mesh that is refined."""
    return whole(problem).mesh


def on_mesh(problem: Problem, mesh: MeshTri) -> Problem:
    """Return the problem with its bodies on a refined `mesh_of`, in their velocity spaces."""
    known = continua(problem)
    finer = {
        name: inheriting.on_mesh(known[name], part, known[name].space)
        for name, part in parted(mesh, list(known)).items()
    }
    return replace(problem, bodies={**problem.bodies, **finer})


def in_bounding_spaces(problem: Problem) -> Problem:
    """Return the problem with its bodies in the velocity spaces of upper bounds.

    Bounds projected from ``p2-gauss`` are a little closer, but fail where mechanisms are not
    unique.
    """
    known = continua(problem).items()
    own = {name: replace(body, space=_space(body, name, problem)) for name, body in known}
    return replace(problem, bodies={**problem.bodies, **own})


def with_jumps(problem: Problem) -> Problem:
    """Return the problem with velocities that are discontinuous between elements."""
    own = {name: replace(body, space="p2-disc") for name, body in continua(problem).items()}
    return replace(problem, bodies={**problem.bodies, **own})


def _space(body: Body, name: str, problem: Problem) -> str:
    """Return the velocity space of upper bounds of a body.

    In three dimensions discontinuous velocities give by far the closest bounds, where they are
    possible. Soil that slips must also separate: if it is held along a face alone, as by a twist or
    a rough obstacle, no such velocity is strictly admissible (T94). In the plane velocities are
    discontinuous under smooth footings on edges that replace an arc, as continuous ones would stick
    to them.
    """
    if body.dimension == 2:
        own = [footing for footing in footings_of(problem) if footing.body == name]
        slides = any(slides_on_chords(footing, body) for footing in own)
        return "p2-disc" if slides else BOUNDING
    if not body.pressure_dependent:
        return "p2-disc"
    opens = all(own.form.opens or not own.form.surfaces for own in body.regions)
    held = {own.components for own in problem.supports if own.body == name}
    across = np.array([[0.0, 0.0, 1.0]])
    footings = [own for own in footings_of(problem) if own.body == name]
    along = any(len(own.held(across)) == 2 for own in footings)
    free = held <= _OPENING and not along and not problem.interfaces
    return "p2-disc" if opens and free else BOUNDING


def elements(problem: Problem, mesh: MeshTri, name: str) -> Ints:
    """Return the numbers of the elements of a body in `mesh_of` its problem."""
    return elements_of(mesh, name, single=len(continua(problem)) == 1)


def of_all(names: list[str], values: Callable[[str], Floats]) -> Floats:
    """Return the values of the elements of all bodies, in the order of `mesh_of`."""
    return np.concatenate([values(name) for name in names])


def with_kept_water(problem: Problem) -> Problem:
    """Return the problem with the water on its present meshes, for use on other meshes."""
    known = continua(problem)

    def held(load: Load) -> Load:
        return kept(load, known[load.body]) if load.body in known else load

    return replace(
        problem,
        reference_loads=[held(load) for load in problem.reference_loads],
        dead_loads=[held(load) for load in problem.dead_loads],
    )
