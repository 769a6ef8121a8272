"""From a `Problem` to the kinematic dual of its lower bound program (T26b)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
from scipy.sparse import block_diag, csr_matrix
from skfem.mesh import MeshTri1

from lacore.arrays import Floats, Ints
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.dofs import RigidDofs
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import boundary_facets, facet_geometry
from lacore.bounds.equilibrium import EquilibriumDofs, element_geometry, number_multipliers
from lacore.bounds.static_contact import traction_rows
from lacore.bounds.static_corners import check_corners
from lacore.conditions.elimination import free_basis, join
from lacore.conditions.loads import (
    BodyForce,
    Fix,
    Load,
    PointForce,
    Pressure,
    RigidFooting,
    Traction,
)
from lacore.conditions.nodes import footing_conditions, support_conditions
from lacore.contact.rows import ContactPoints
from lacore.errors import InputError
from lacore.problem.problem import Problem
from lacore.program import KinematicProgram
from lacore.reduction import kept_points, reduced
from lacore.scales import Scales
from lacore.showing import Facts, Shown, counted, listed, sized

_ROUND_OFF = 1e-12  # of the load that remains where supports take all of it


@dataclass(frozen=True, repr=False)
class StaticModel(Shown):
    """An assembled lower bound problem.

    Attributes:
        problem: what was assembled.
        full: the program for all multipliers, SI units.
        program: the program for the free unknowns, SI units; stresses, reactions and load factor
            are its multipliers.
        bodies: continua by name.
        assemblies: rigid blocks by name.
        points: geometry of the contact points, the ends of facets and of joints.
        natural: scales in which the quantities of the answer are of order one.
    """

    problem: Problem
    full: KinematicProgram
    program: KinematicProgram
    bodies: Mapping[str, EquilibriumDofs]
    assemblies: Mapping[str, RigidDofs]
    points: ContactPoints
    natural: Scales

    @property
    def contents(self) -> str:
        """``576 elements, 7489 unknowns, 0 contact points``."""
        return sized(self.n_elements, self.program.n, self.program.contact.count)

    def facts(self) -> Facts:
        """What it consists of."""
        told = {
            "size": f"{self.contents}; {self.full.n} unknowns with those that are held",
            "bodies": listed(self.problem.bodies),
        }
        return Facts(f"StaticModel: {counted(self.program.n, 'free multiplier')}", told)

    @property
    def n_elements(self) -> int:
        """Triangles and rigid blocks."""
        triangles = sum(int(dofs.body.mesh.nelements) for dofs in self.bodies.values())
        return triangles + sum(len(dofs.body.names) for dofs in self.assemblies.values())


def static_model(problem: Problem) -> StaticModel:
    """Assemble the lower bound problem.

    Raises:
        InputError: what equilibrium elements cannot state (bodies that are no straight triangles
            and no rigid blocks, point forces on continua, friction that is not associated,
            interfaces whose meshes do not match, blocks whose edges end inside one of an element,
            loads that ask for two shear stresses at a corner of one element), a reference load
            that does no power.
    """
    if not isinstance(problem, Problem):
        raise InputError(
            "problem",
            type(problem).__name__,
            "not a problem",
            "give a lacore.Problem; that of a state is state.discretisation.problem",
        )
    bodies = number_multipliers(_continua(problem))
    _check_statable(problem)
    loads = [*problem.reference_loads, *problem.dead_loads]
    footings = list(dict.fromkeys(_unloaded(f) for f in loads if isinstance(f, RigidFooting)))
    nodes = sum(dofs.count for dofs in bodies.values())
    node_dofs = np.arange(2 * nodes).reshape(-1, 2).T
    n = 2 * nodes + len(footings)
    assemblies: dict[str, RigidDofs] = {}
    for name, body in problem.bodies.items():
        if isinstance(body, BlockAssembly):
            assemblies[name] = RigidDofs(body, n)
            n += assemblies[name].count

    contact, points = traction_rows(problem.interfaces, {**bodies, **assemblies}, n)
    full = KinematicProgram(
        groups=tuple(dofs.group(name, n) for name, dofs in bodies.items()),
        contact=contact,
        reference_load=_load_vector(problem.reference_loads, bodies, assemblies, footings, n),
        dead_load=_load_vector(problem.dead_loads, bodies, assemblies, footings, n),
    )
    conditions = join(
        [
            *(
                support_conditions(s, *_ends(bodies[s.body], s))
                for s in problem.supports
                if s.body in bodies
            ),
            *(
                footing_conditions(footing, *_ends(bodies[footing.body], footing), number)
                for number, footing in enumerate(footings)
            ),
        ]
    )
    basis = csr_matrix(
        block_diag(
            [
                free_basis(conditions, node_dofs, [footing.name for footing in footings]),
                *(
                    dofs.free([s for s in problem.supports if s.body == name])
                    for name, dofs in assemblies.items()
                ),
            ],
            format="csr",
        )
    )
    check_corners(full, basis, bodies)
    program = reduced(full, basis)
    # What a support takes altogether needs no reaction.
    kept = np.diff(program.contact.normal.indptr) + np.diff(program.contact.tangential.indptr) > 0
    full, program = (replace(p, contact=kept_points(p.contact, kept)) for p in (full, program))
    size = float(np.abs(full.reference_load).sum())
    if np.sum(np.abs(program.reference_load)) <= _ROUND_OFF * size:
        raise InputError(
            "Problem.reference_loads",
            None,
            "they do no power (F0 = 0): they cancel, or act where supports hold the body",
            "load a boundary that can move, or release the support",
        )
    return StaticModel(
        problem=problem,
        full=full,
        program=program,
        bodies=bodies,
        assemblies=assemblies,
        points=points.kept(kept),
        natural=Scales(
            length=sqrt(sum(float(element_geometry(d.body)[0].sum()) for d in bodies.values())),
            stress=sqrt(3) * max(dofs.strength for dofs in bodies.values()),
            velocity=1 / size,
        ),
    )


def _continua(problem: Problem) -> dict[str, Body]:
    bodies: dict[str, Body] = {}
    for name, body in problem.bodies.items():
        if isinstance(body, BlockAssembly):
            continue
        if not isinstance(body, Body):
            raise InputError(
                f"Problem.bodies[{name!r}]",
                type(body).__name__,
                "a lower bound takes deformable bodies and rigid blocks only",
                "make it a lacore.Body or a BlockAssembly; `solve` bounds problems of frames by"
                " coupling='frictionless' and 'associated'",
            )
        if type(body.mesh) is not MeshTri1:
            raise InputError(
                f"Problem.bodies[{name!r}].mesh",
                type(body.mesh).__name__,
                "equilibrium elements are straight-edged triangles",
                "give a skfem.MeshTri, for quadrilaterals `mesh.to_meshtri(style='x')`",
            )
        if body.axisymmetric:
            raise InputError(
                f"Problem.bodies[{name!r}].kinematics",
                body.kinematics,
                "no lower bound: linear stresses cannot be in equilibrium with the hoop stress over"
                " r",
                "take `solve`, whose value converges, and is no bound",
            )
        bodies[name] = body
    if not bodies:
        raise InputError(
            "Problem.bodies",
            list(problem.bodies),
            "a lower bound takes rigid blocks beside deformable bodies only",
            "take `solve`: of rigid blocks alone what it certifies is exact, and coupling="
            "'frictionless' and 'associated' bound every Coulomb load factor",
        )
    return bodies


def _check_statable(problem: Problem) -> None:
    for attribute in ("reference_loads", "dead_loads"):
        for index, load in enumerate(getattr(problem, attribute)):
            if isinstance(load, PointForce) and isinstance(problem.bodies[load.body], Body):
                raise InputError(
                    f"Problem.{attribute}[{index}]",
                    load.vector,
                    "stresses that are linear in a triangle cannot carry a point force",
                    "spread it over an edge as a Traction",
                )
    for index, interface in enumerate(problem.interfaces):
        if interface.law.terms().coefficient > 0:
            raise InputError(
                f"Problem.interfaces[{index}].friction",
                interface.name,
                "Coulomb friction is not associated, and the bound theorems do not hold with it",
                "give Coulomb(mu, associated=True), or SMOOTH, whose lower bound is one of every"
                " Coulomb load factor too, as `bracket` takes it",
            )
    for name, body in problem.bodies.items():
        if isinstance(body, BlockAssembly) and np.any(body.joints.coefficient > 0):
            raise InputError(
                f"Problem.bodies[{name!r}].friction",
                None,
                "Coulomb friction of joints is not associated, and the bound theorems do not hold"
                " with it",
                "give Coulomb(mu, associated=True), or SMOOTH, as `bracket` does for its two ends",
            )


def _facets(dofs: EquilibriumDofs, part: Fix | Traction | Pressure | RigidFooting) -> Ints:
    return boundary_facets(dofs.body, part.where, f"{type(part).__name__}.where")


def _unloaded(footing: RigidFooting) -> RigidFooting:
    return replace(footing, pressure=1.0)


def _load_vector(
    loads: Sequence[Load],
    bodies: Mapping[str, EquilibriumDofs],
    assemblies: Mapping[str, RigidDofs],
    footings: Sequence[RigidFooting],
    n: int,
) -> Floats:
    """Forces on the multipliers, shape (n,), N/m; those of a footing on its own unknown."""
    total = np.zeros(n)
    first = 2 * sum(dofs.count for dofs in bodies.values())  # of the footings
    for load in loads:
        if load.body in assemblies:
            own = assemblies[load.body]
            total[own.offset : own.offset + own.count] += own.force(load)
            continue
        dofs = bodies[load.body]
        if isinstance(load, BodyForce):
            force = element_geometry(dofs.body)[0] * np.reshape(load.vector, (2, 1))
            nodes = dofs.element_nodes
        elif isinstance(load, RigidFooting):
            place = first + footings.index(_unloaded(load))
            total[place] += load.pressure * float(dofs.lengths(_facets(dofs, load)).sum())
            continue
        else:
            assert isinstance(load, Traction | Pressure)
            facets = _facets(dofs, load)
            start, end, outward = facet_geometry(dofs.body, facets)
            vector = (
                -load.value * outward
                if isinstance(load, Pressure)
                else np.reshape(load.vector, (2, 1))
            )
            half = np.linalg.norm(end - start, axis=0) / 2 * vector
            force, nodes = np.tile(half, 2), dofs.facet_nodes(facets).ravel()
        for axis in (0, 1):
            np.add.at(total, 2 * nodes + axis, force[axis])
    return total


def _ends(dofs: EquilibriumDofs, part: Fix | RigidFooting) -> tuple[Ints, Floats]:
    """Nodes at the ends of facets and the outward normal there: (2 k,), (2 k, 2)."""
    facets = _facets(dofs, part)
    _, _, outward = facet_geometry(dofs.body, facets)
    return dofs.facet_nodes(facets).ravel(), np.tile(outward.T, (2, 1))
