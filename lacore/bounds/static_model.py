"""Assembly of the kinematic dual of the lower bound program of a `Problem` (T26b)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import cbrt, sqrt

import numpy as np
from scipy.sparse import block_diag, csr_matrix
from skfem.mesh import MeshTet1, MeshTri1

from lacore.assembly.bonds import rigid_basis, supports_of
from lacore.assembly.loading import count_speeds, load_vector, numbered_speeds, require_power
from lacore.assembly.natural import strengths_of
from lacore.bounds.enclosing import (
    named_criterion,
    require_associated_flow,
    require_known_fields,
)
from lacore.bounds.equilibrium import EquilibriumDofs, element_geometry
from lacore.bounds.quadratic.bulging import Bulging, lifted, weakened
from lacore.bounds.solid.static_contact import face_tractions, static_free_basis
from lacore.bounds.static_bonds import StaticBonds, static_bonds
from lacore.bounds.static_contact import traction_rows
from lacore.bounds.static_corners import check_corners
from lacore.model.bodies.any_body import numbered, of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import require_carried
from lacore.model.bodies.continuum.boundaries import facet_geometry, facets_of
from lacore.model.bodies.continuum.regions.gathering import by_body
from lacore.model.bodies.continuum.regions.lending import lend, strengthless
from lacore.model.bodies.continuum.solid.memory import require_memory, stress_memory, told_memory
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.elimination import free_basis, join
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Fix
from lacore.model.conditions.nodes import footing_conditions, support_conditions
from lacore.model.contact.rows import ContactPoints
from lacore.model.meshes.curved import vertices
from lacore.model.problem.matching import matching
from lacore.model.problem.problem import Problem
from lacore.model.problem.wet import acting
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup, KinematicProgram, Scales
from lacore.program.reduction import held_shut, kept_points, reduced
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Facts, Shown, counted, listed, sized
from lacore.reporting.text import Quantity, text


@dataclass(frozen=True, repr=False)
class StaticModel(Shown):
    """Assembled lower bound problem.

    Attributes:
        problem: the problem.
        full: program of all multipliers, SI units.
        program: program of the free unknowns, SI units; stresses, reactions and load factor are its
            multipliers.
        continua: deformable bodies by name.
        assemblies: rigid blocks by name.
        points: geometry of the contact points, the ends of facets and of joints.
        bonds: multipliers that bonded interfaces join.
        natural: scales in which the results are of order one.
        bulging: quadratic stresses, in addition to the linear ones, of body forces that vary.
    """

    problem: Problem
    full: KinematicProgram
    program: KinematicProgram
    continua: Mapping[str, EquilibriumDofs]
    assemblies: Mapping[str, RigidDofs[BlockAssembly]]
    points: ContactPoints
    bonds: StaticBonds
    natural: Scales
    bulging: Bulging

    @property
    def contents(self) -> str:
        """``576 elements, 7489 unknowns, 0 contact points``."""
        return sized(self.n_elements, self.program.n, self.program.contact.count)

    def facts(self) -> Facts:
        """Return the size and contents of the model, for printing."""
        told = {
            "size": f"{self.contents}; {self.full.n} unknowns with those that are held",
            "bodies": listed(self.problem.bodies),
        }
        if needed := stress_memory({name: dofs.body for name, dofs in self.continua.items()}):
            told["memory"] = told_memory(needed)
        return Facts(f"StaticModel: {counted(self.program.n, 'free multiplier')}", told)

    def weakened(self, load_factor: float) -> "StaticModel":
        """Return the model with strengths reduced by quadratic stresses up to a load factor.

        Raises:
            InputError: no strength remains somewhere.
        """
        full, program = (
            weakened(own, self.continua, self.bulging, load_factor)
            for own in (self.full, self.program)
        )
        return replace(self, full=full, program=program)

    @property
    def n_elements(self) -> int:
        """Triangles, or tetrahedra, and rigid blocks."""
        triangles = sum(int(dofs.body.mesh.nelements) for dofs in self.continua.values())
        return triangles + sum(len(dofs.body.names) for dofs in self.assemblies.values())


def static_model(problem: Problem) -> StaticModel:
    """Assemble the lower bound problem.

    Raises:
        InputError: features that equilibrium elements do not support (bodies that are neither
            straight triangles nor rigid blocks, point forces on continua, non-associated friction,
            interfaces whose meshes do not match, blocks whose edges end inside one of an element,
            loads that require two shear stresses at a corner of one element), or a reference load
            without power.
    """
    continua = _continua(problem)
    solid = any(body.dimension == 3 for body in continua.values())
    require_memory(stress_memory(continua), continua)
    problem = matching(problem)
    bodies = numbered(_continua(problem), EquilibriumDofs.at)
    _check_statable(problem)
    first = sum(dofs.count for dofs in bodies.values())
    footings = numbered_speeds(problem, first)
    after = first + count_speeds(footings)
    assemblies = numbered(of_kind(problem.bodies, BlockAssembly), RigidDofs, after)
    n = after + sum(own.count for own in assemblies.values())
    dofs: dict[str, EquilibriumDofs | RigidDofs[BlockAssembly]] = {**bodies, **assemblies}
    plane = {} if solid else bodies  # In three dimensions body forces are uniform in each element.
    bulging = Bulging.of(problem, plane)
    if solid:
        contact, points = face_tractions(problem.interfaces, problem.touching, bodies, n)
    else:
        contact, points = traction_rows(problem.interfaces, problem.segments, bodies, assemblies, n)
    touched = problem.bodies, problem.interfaces
    full = KinematicProgram(
        groups=tuple(group for name, own in bodies.items() for group in own.groups(name, n)),
        contact=contact,
        reference_load=load_vector(
            acting(problem.reference_loads, *touched), dofs, bodies, footings, n
        )
        + lifted(plane, bulging.reference, n),
        dead_load=load_vector(acting(problem.dead_loads, *touched), dofs, bodies, footings, n)
        + lifted(plane, bulging.dead, n),
    )
    if solid:
        bonds = static_bonds((), (), bodies, assemblies, join([]), n)
        basis = static_free_basis(bodies, problem.supports, tuple(footings))
    else:
        bonds, basis = _in_plane(problem, bodies, footings, assemblies, n)
        check_corners(full, basis, bodies)
    program = reduced(full, basis)
    # Points whose force a support takes completely need no reaction.
    contact = program.contact
    slides = np.diff(contact.tangential.indptr).reshape(-1, contact.tangent_dim).any(axis=1)
    kept = slides | (np.diff(contact.normal.indptr) > 0)
    full, program = (
        held_shut(replace(p, contact=kept_points(p.contact, kept))) for p in (full, program)
    )
    size = float(np.abs(full.reference_load).sum())
    require_power(program.reference_load, size)
    for name, own, groups in by_body(bodies, full.groups):
        require_cohesion(name, own.body, full.dead_load)
        _check_left(name, own, groups)
    extent = sum(float(element_geometry(d.body)[0].sum()) for d in bodies.values())
    length = cbrt(extent) if solid else sqrt(extent)
    thickness = length if solid else 1.0
    return StaticModel(
        problem=problem,
        full=full,
        program=program,
        continua=bodies,
        assemblies=assemblies,
        points=points.kept(kept),
        bonds=bonds,
        bulging=bulging,
        natural=Scales(
            length=length,
            stress=max(strengths_of(full.groups, full.dead_load, length * thickness)),
            velocity=1 / size,
            thickness=thickness,
        ),
    )


def _in_plane(
    problem: Problem,
    bodies: Mapping[str, EquilibriumDofs],
    footings: Mapping[Footing, int],
    assemblies: Mapping[str, RigidDofs[BlockAssembly]],
    n: int,
) -> tuple[StaticBonds, Sparse]:
    """Return the bonds, and all multipliers from the free ones."""
    node_dofs = np.arange(sum(own.count for own in bodies.values())).reshape(-1, 2).T
    conditions = join(
        [
            *(
                support_conditions(s, *_ends(bodies[s.body], s))
                for s in supports_of(problem)
                if s.body in bodies
            ),
            *(
                footing_conditions(footing, *_ends(bodies[footing.body], footing), number)
                for number, footing in enumerate(footings)
            ),
        ]
    )
    bonds = static_bonds(problem.interfaces, problem.segments, bodies, assemblies, conditions, n)
    conditions = join([conditions, bonds.conditions])
    basis = csr_matrix(
        block_diag(
            [
                free_basis(conditions, node_dofs, [footing.name for footing in footings]),
                rigid_basis(problem, assemblies, n),
            ],
            format="csr",
        )
    )
    return bonds, bonds.spread(basis)


def _continua(problem: Problem) -> dict[str, Body]:
    for name in of_kind(problem.bodies, Frame):
        raise InputError(
            f"Problem.bodies[{name!r}]",
            "Frame",
            "a lower bound takes deformable bodies and rigid blocks only",
            "make it a lacore.Body or a BlockAssembly; `solve` bounds problems of frames by"
            " coupling='frictionless' and 'associated'",
        )
    bodies = of_kind(problem.bodies, Body)
    for name, body in bodies.items():
        if type(body.mesh) not in (MeshTri1, MeshTet1):
            raise InputError(
                f"Problem.bodies[{name!r}].mesh",
                type(body.mesh).__name__,
                "equilibrium elements are straight-edged triangles, or tetrahedra",
                "give a skfem.MeshTri, for quadrilaterals `mesh.to_meshtri(style='x')`",
            )
        if body.axisymmetric:
            raise InputError(
                f"Problem.bodies[{name!r}].kinematics",
                body.kinematics,
                "no lower bound: linear stresses cannot be in equilibrium with the hoop stress over"
                " r",
                "take `solve`, whose value converges, but is not a bound",
            )
    if not bodies:
        raise InputError(
            "Problem.bodies",
            list(problem.bodies),
            "a lower bound takes rigid blocks only together with deformable bodies",
            "take `solve`: of rigid blocks alone what it certifies is exact, and coupling="
            "'frictionless' and 'associated' bound every Coulomb load factor",
        )
    return bodies


def require_cohesion(name: str, body: Body, dead_load: Floats) -> None:
    """Raise `InputError` for soils without cohesion, as floating point could not prove a bound."""
    for region in strengthless(body):
        raise InputError(
            named_criterion(name, region),
            region.criterion.label,
            "no cohesion or no tensile strength, without which floating-point arithmetic cannot"
            " prove a lower bound",
            text("{}; the bound is then one of that material", lend(body, dead_load)),
        )


def _check_left(name: str, dofs: EquilibriumDofs, groups: Sequence[DissipationGroup]) -> None:
    """Raise `InputError` for elements whose known lower limit of strength is not positive."""
    for region, group in zip(dofs.body.regions, groups, strict=True):
        least = group.bound if group.surfaces is None else group.surfaces.strength.min(axis=1)
        none = np.flatnonzero(least.reshape(region.elements.size, -1).min(axis=1) <= 0)
        if none.size:
            mesh = dofs.body.mesh
            centre = vertices(mesh)[:, mesh.t[:, region.elements[none[0]]]].mean(axis=1)
            raise InputError(
                named_criterion(name, region),
                region.criterion.label,
                text(
                    "elements as large as that near {} may have no strength anywhere, by the "
                    "steepest slope of its field ({} of them)",
                    Quantity(tuple(centre), "m", ".6g"),
                    none.size,
                ),
                "give less of it if the function is less steep, or refine the mesh there",
            )


def _check_statable(problem: Problem) -> None:
    deforming = of_kind(problem.bodies, Body)
    require_associated_flow(of_kind(problem.bodies, Body))
    require_known_fields(problem)
    for field, load in problem.loads.items():
        if load.body in deforming:
            require_carried(load, deforming[load.body].mesh, field)
        if load.point is not None and load.body in deforming:
            raise InputError(
                field,
                load.told,
                "stresses that are linear in a triangle cannot carry a point force",
                "spread it over an edge as a Traction",
            )
    for index, interface in enumerate(problem.interfaces):
        if interface.law.terms().coefficient > 0:
            raise InputError(
                f"Problem.interfaces[{index}].friction",
                interface.name,
                "Coulomb friction is not associated, and the bound theorems do not hold with it",
                text(
                    "give {}, or {}, whose lower bound is one of every Coulomb load factor too, as"
                    " `bracket` takes it",
                    terms.ASSOCIATED,
                    terms.SMOOTH,
                ),
            )
    for name, body in of_kind(problem.bodies, BlockAssembly).items():
        if np.any(body.joints.coefficient > 0):
            raise InputError(
                f"Problem.bodies[{name!r}].friction",
                None,
                "Coulomb friction of joints is not associated, and the bound theorems do not hold"
                " with it",
                text(
                    "give {}, or {}, as `bracket` does for its two ends",
                    terms.ASSOCIATED,
                    terms.SMOOTH,
                ),
            )


def _ends(dofs: EquilibriumDofs, part: Fix | Footing) -> tuple[Ints, Floats]:
    """Return nodes at the ends of facets and the outward normal there: (2 k,), (2 k, 2)."""
    facets = facets_of(part, dofs.body.mesh)
    _, _, outward = facet_geometry(dofs.body.mesh, facets)
    return dofs.facet_nodes(facets).ravel(), np.tile(outward.T, (2, 1))
