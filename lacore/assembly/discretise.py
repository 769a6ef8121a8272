"""From a `Problem` to the kinematic program (T6), vectorised."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum, sqrt

import numpy as np
from scipy.sparse import block_diag, csr_matrix
from skfem import Basis, FacetBasis, LinearForm
from skfem.mesh import MeshTri1

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.assembly.ordering import column_order, point_order
from lacore.assembly.slips import slips
from lacore.assembly.span_nodes import spanned
from lacore.assembly.sticking import yielding
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.blocks.dofs import RigidDofs
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import boundary_facets, outward_normals, vertex_at
from lacore.bodies.continuum.dofs import BodyDofs, number
from lacore.bodies.continuum.jumps import Jumps, jumps, movable
from lacore.bodies.continuum.slip import Slip
from lacore.bodies.continuum.volume import volume_projector
from lacore.bodies.frames.dofs import FrameDofs
from lacore.bodies.frames.frame import Frame
from lacore.conditions.elimination import NodeConditions, free_basis, held, join
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
from lacore.contact.controls import Dofs
from lacore.contact.interfaces import Interface
from lacore.contact.rows import ContactPoints, contact_rows
from lacore.errors import InputError
from lacore.meshes.curved import is_curved
from lacore.problem.problem import Problem
from lacore.program import ContactRows, DissipationGroup, KinematicProgram
from lacore.reduction import kept_points, reduced
from lacore.scales import Scales
from lacore.showing import Facts, Picture, Shown, counted, listed, sized
from lacore.status import Scope

_STRAIGHT = 1 - 1e-9  # cosine between (or mean length of) normals of edges on one line
_CORNER = 0.5  # cosine of a corner that is meant: edges turn by 60 degrees and more
# Exact: velocities of degree 2, times an area that is linear on straight quadrilaterals; on curved
# ones it is cubic in either direction, and the radius is quadratic.
_LOAD_ORDER, _CURVED_ORDER = 3, 7


@dataclass(frozen=True, repr=False)
class Discretisation(Shown):
    """An assembled problem.

    Attributes:
        problem: what was assembled.
        full: the program for all unknowns, SI units.
        program: the program for the free unknowns q, SI units.
        free_basis: ``U = free_basis @ q``.
        held_nodes: which nodes a support or a footing acts on, shape (nodes of all continua,).
        bodies: continua by name.
        assemblies: rigid blocks by name.
        frames: frames by name; their hinges are the groups of these names.
        jumps: velocity jumps of the continua (T23), by name: of those whose space has them, and
            of those that slip along boundaries. Groups of the programs: the continua, these, the
            hinges of frames.
        slips: the boundaries along which continua slip past what holds them, by name.
        points: geometry of the contact points.
        shared_corners: contact points with friction at corners that are in contact on both sides:
            the reactions there, and with them the load factor, may not be unique, shape (m,).
        footings: unknowns of the footings, each the speed of one along its direction, in the order
            of the loads, shape (f,).
        natural: scales in which the quantities of the answer are of order one (T20).
    """

    problem: Problem
    full: KinematicProgram
    program: KinematicProgram
    free_basis: Sparse
    held_nodes: Bools
    bodies: Mapping[str, BodyDofs]
    assemblies: Mapping[str, RigidDofs]
    frames: Mapping[str, FrameDofs]
    jumps: Mapping[str, Jumps]
    slips: Mapping[str, Slip]
    points: ContactPoints
    shared_corners: Bools
    footings: Ints
    natural: Scales

    @property
    def scope(self) -> Scope:
        """Of which problem its load factors are."""
        return Scope.DISCRETE if self.bodies else Scope.ITSELF

    @property
    def contents(self) -> str:
        """``576 elements, 2401 unknowns, 12 contact points``."""
        return sized(self.n_elements, self.program.n, self.program.contact.count)

    def facts(self) -> Facts:
        """What it consists of."""
        natural, free = self.natural, counted(self.program.n, "free unknown")
        told = {
            "size": f"{self.contents}; {self.full.n} unknowns with those that are held",
            "bodies": listed(self.problem.bodies),
            "contact": listed(self.points.names) or "none",
            "scales": f"{natural.length:.4g} m, {natural.stress:.4g} Pa",
        }
        return Facts(f"Discretisation: {free}, of {self.scope.value}", told)

    def picture(self) -> Picture:
        """The problem."""
        return Picture(self.problem.plot(), "the problem")

    @property
    def n_elements(self) -> int:
        """Elements of meshes, rigid blocks and rigid pieces of members."""
        elements = sum(dofs.body.mesh.nelements for dofs in self.bodies.values())
        blocks = sum(len(dofs.body.names) for dofs in self.assemblies.values())
        return int(elements) + blocks + sum(f.body.pieces.start.size for f in self.frames.values())


Contact = Callable[
    [Sequence[Interface], Mapping[str, Dofs], int], tuple[ContactRows, ContactPoints]
]
"""Rows of interfaces for n unknowns of bodies: see `lacore.contact.rows.contact_rows`."""


def discretise(problem: Problem, contact_of: Contact = contact_rows) -> Discretisation:
    """Assemble a problem, its contact by `contact_of`.

    Raises:
        InputError: a footing that cannot move, a reference load that does no power because it
            acts on supports alone, rigid bodies under no dead load.
    """
    if not isinstance(problem, Problem):
        raise InputError("problem", problem, "not a problem", "give a lacore.Problem")
    problem = spanned(problem)
    footings = _footings(problem)
    bodies = number({n: b for n, b in problem.bodies.items() if isinstance(b, Body)})
    node_dofs = np.concatenate(
        [np.zeros((2, 0), dtype=np.int64), *(dofs.dofs for dofs in bodies.values())], axis=1
    )
    n = node_dofs.size + len(footings)
    assemblies: dict[str, RigidDofs] = {}
    for name, body in problem.bodies.items():
        if isinstance(body, BlockAssembly):
            assemblies[name] = RigidDofs(body, n)
            n += assemblies[name].count
    frames: dict[str, FrameDofs] = {}
    for name, body in problem.bodies.items():
        if isinstance(body, Frame):
            frames[name] = FrameDofs(body, n)
            n += frames[name].count
    rigid: dict[str, RigidDofs | FrameDofs] = {**assemblies, **frames}  # in order of unknowns

    interfaces = yielding(problem, bodies, footings)
    contact, points = contact_of(interfaces, {**bodies, **rigid}, n)
    slipping = slips(problem, bodies, footings, node_dofs.size)
    jumping = {
        name: jumps(name, dofs, n, slipping.get(name))
        for name, dofs in bodies.items()
        if dofs.space.jumps or name in slipping
    }
    supports = [support for support in problem.supports if support.body in bodies]
    conditions = join(
        [
            *(
                _support_conditions(support, bodies[support.body], slipping.get(support.body))
                for support in supports
            ),
            *(
                _footing_conditions(
                    footing, bodies[footing.body], slipping.get(footing.body), number
                )
                for number, footing in enumerate(footings)
            ),
            *(slip.conditions(bodies[name]) for name, slip in slipping.items()),
        ]
    )
    slid = [slip.nodes(bodies[name]).ravel() for name, slip in slipping.items()]
    held_nodes = np.isin(np.arange(node_dofs.shape[1]), np.concatenate([conditions.nodes, *slid]))
    # On an axis u_r = 0 follows from continuity: no support, and no reaction.
    axes = np.concatenate([np.zeros(0, dtype=np.int64), *(b.axis_nodes for b in bodies.values())])
    conditions = join([conditions, held(axes, np.tile([1.0, 0.0], (axes.size, 1)))])
    basis = csr_matrix(
        block_diag(
            [
                free_basis(conditions, node_dofs, [f.name for f in footings]),
                *(
                    dofs.free([s for s in problem.supports if s.body == name])
                    for name, dofs in rigid.items()
                ),
            ],
            format="csr",
        )
    )
    basis = csr_matrix(basis[:, column_order(basis, assemblies)])
    jumping = {name: part.kept(movable(part.group, basis)) for name, part in jumping.items()}
    jumping = {name: part for name, part in jumping.items() if part.group.weights.size}
    full = KinematicProgram(
        groups=(
            *(_plasticity(name, dofs, n) for name, dofs in bodies.items()),
            *(part.group for part in jumping.values()),
            *(group for name, dofs in frames.items() for group in dofs.groups(name, n)),
        ),
        contact=contact,
        reference_load=_load_vector(problem.reference_loads, bodies, rigid, footings, n),
        dead_load=_load_vector(problem.dead_loads, bodies, rigid, footings, n),
        parts=_parts(bodies, rigid, footings, n),
    )
    program = reduced(full, basis)
    order = point_order(contact, points, assemblies, len(problem.interfaces))
    kept = order[_movable(program.contact, points)[order]]
    full, program = (replace(p, contact=kept_points(p.contact, kept)) for p in (full, program))
    points = points.kept(kept)
    size = _load_size(full.reference_load, node_dofs)
    # Round-off of the nodal sums; a load that can do power keeps at least one whole nodal force.
    if np.sum(np.abs(program.reference_load)) <= 1e-12 * size:
        raise InputError(
            "Problem.reference_loads",
            None,
            "they do no power (F0 = 0): they cancel, or act where supports hold the body",
            "load a boundary that can move, or release the support",
        )
    return Discretisation(
        problem=problem,
        full=full,
        program=program,
        free_basis=basis,
        held_nodes=held_nodes,
        bodies=bodies,
        assemblies=assemblies,
        frames=frames,
        jumps=jumping,
        slips=slipping,
        points=points,
        shared_corners=_shared_corners(program.contact, points, problem),
        footings=node_dofs.size + np.arange(len(footings)),
        natural=_natural_scales(program, bodies, rigid, 1 / size),
    )


def _parts(
    bodies: Mapping[str, BodyDofs],
    rigid: Mapping[str, RigidDofs | FrameDofs],
    footings: Sequence[RigidFooting],
    n: int,
) -> Ints:
    """What each unknown belongs to, shape (n,): a continuum with its footings, a block, a frame."""
    parts, number = np.zeros(n, dtype=np.int64), {name: k for k, name in enumerate(bodies)}
    for name, dofs in bodies.items():
        parts[dofs.dofs] = number[name]
    first = n - sum(dofs.count for dofs in rigid.values()) - len(footings)
    for place, footing in enumerate(footings, start=first):
        parts[place] = number[footing.body]
    count = len(bodies)
    for own in rigid.values():
        pieces = own.pieces_of_unknowns
        parts[own.offset : own.offset + own.count] = count + pieces
        count += int(pieces.max(initial=-1)) + 1
    return parts


def _natural_scales(
    program: KinematicProgram,
    bodies: Mapping[str, BodyDofs],
    rigid: Mapping[str, RigidDofs | FrameDofs],
    velocity: float,
) -> Scales:
    """Scales of the answer: strengths of continua, else of hinges, else those of the dead load.

    Raises:
        InputError: nothing sets a scale of stress; the load factor would be 0 or any number.
    """
    length = sqrt(fsum(body.extent for body in (*bodies.values(), *rigid.values())))
    yielding = program.groups[: len(bodies)] or program.groups
    strengths = [sqrt(3) * float(group.bound.max()) for group in yielding]
    if not strengths:
        limit = program.contact.limit
        strengths = [
            fsum(np.abs(program.dead_load)) / length,  # whatever the order
            float(limit[np.isfinite(limit)].max(initial=0.0)),
        ]
    if not max(strengths) > 0:
        raise InputError(
            "Problem.dead_loads",
            None,
            "rigid bodies under no dead load, without cohesion: nothing sets a scale of forces, the"
            " load factor would always be 0",
            "give dead_loads (the own weight: BodyForce), a Tresca friction, or a body that yields",
        )
    volume = sum(float(body.weights.sum()) for body in bodies.values())
    area = sum(body.extent for body in bodies.values())
    thickness = volume / area if any(b.body.axisymmetric for b in bodies.values()) else 1.0
    return Scales(length, max(strengths), velocity, thickness)


def _shared_corners(contact: ContactRows, points: ContactPoints, problem: Problem) -> Bools:
    """Coulomb points at corners of continua that meet contact of another direction, shape (m,).

    Raises:
        InputError: the other one sticks by law, and so takes an unknown part of the normal force.
    """
    bodies = list(problem.bodies)
    # Joints of rigid blocks, numbered after the interfaces, meet at corners as a rule.
    own = contact.interface < len(problem.interfaces)
    owner = [
        bodies.index(interface.slave[0])
        if isinstance(problem.bodies[interface.slave[0]], Body)
        else -1
        for interface in problem.interfaces
    ]
    body = np.full(contact.count, -1.0)
    body[own] = np.array(owner, dtype=float)[contact.interface[own]]
    place = np.column_stack([body, points.moving[:, 0], points.position])
    _, node, count = np.unique(place, axis=0, return_inverse=True, return_counts=True)
    node = node.ravel()
    resultant = np.zeros((count.size, 2))
    np.add.at(resultant, node, points.normal)
    turns = (np.linalg.norm(resultant, axis=1) < count * _STRAIGHT)[node] & (body >= 0)
    sticking = np.bincount(node, np.isinf(contact.limit), minlength=count.size)[node] > 0
    wrong = np.flatnonzero(contact.coulomb & turns & sticking)
    if wrong.size:
        raise InputError(
            "Problem.interfaces",
            points.names[int(contact.interface[wrong[0]])],
            f"meets an interface that sticks at {points.position[wrong[0]]}, which holds the normal"
            " velocity where friction needs the normal reaction",
            "end one of the two beside the corner, or give the other a friction coefficient",
        )
    return np.asarray(contact.coulomb & turns)


def _movable(contact: ContactRows, points: ContactPoints) -> Bools:
    """Contact points that no support holds altogether, shape (m,).

    A held point carries what the support carries: its reaction is undetermined and its slip zero.

    Raises:
        InputError: a point that slides with friction, while a support takes its normal force: any
            friction would be as good as any other.
    """
    held = np.diff(contact.normal.indptr) == 0
    slides = np.diff(contact.tangential.indptr).reshape(-1, contact.tangent_dim).any(axis=1)
    loose = np.flatnonzero(held & slides & contact.coulomb)
    if loose.size:
        raise InputError(
            "Problem.interfaces",
            points.names[int(contact.interface[loose[0]])],
            f"a support holds the normal velocity at {points.position[loose[0]]}, where friction"
            " needs the normal reaction",
            "let the support end beside the interface, or hold both components",
        )
    return np.asarray(~(held & ~slides))


def _plasticity(name: str, dofs: BodyDofs, n: int) -> DissipationGroup:
    form = dofs.body.form
    basis = dofs.basis
    gradient = np.stack([np.asarray(shape[0].grad) for shape in basis.basis], axis=-1)
    rates = [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
    if dofs.body.axisymmetric:  # strain points lie off the axis
        radial = np.stack([np.asarray(shape[0])[0] for shape in basis.basis], axis=-1)
        radius = np.asarray(basis.global_coordinates())[0]
        rates.insert(2, radial / radius[:, :, None])
    strain = np.stack(rates, axis=2)
    # strain: (elements, points, components, shapes)
    columns = basis.element_dofs.T.astype(np.int64) + dofs.offset

    def rows(coefficients: Floats) -> Sparse:
        values = np.einsum("rs,epsi->epri", coefficients, strain)
        count = int(np.prod(values.shape[:3]))
        indices = np.broadcast_to(columns[:, None, None, :], values.shape)
        start = np.arange(count + 1) * values.shape[3]
        return csr_matrix((values.ravel(), indices.ravel(), start), shape=(count, n))

    weights = dofs.weights.ravel()
    volumetric = csr_matrix(volume_projector(dofs) @ rows(form.volumetric[None, :]))
    return DissipationGroup(
        name=name,
        rows=rows(form.rows),
        dim=form.rows.shape[0],
        weights=weights,
        bound=np.repeat(form.bounds(np.arange(dofs.body.mesh.nelements)), dofs.weights.shape[1]),
        volumetric=volumetric,
        volumetric_factor=form.volumetric_factor,
    )


def _load_vector(
    loads: Sequence[Load],
    bodies: Mapping[str, BodyDofs],
    rigid: Mapping[str, RigidDofs | FrameDofs],
    footings: Sequence[RigidFooting],
    n: int,
) -> Floats:
    """Nodal forces of loads, shape (n,), N/m; a footing's load acts on its own unknown."""
    total = np.zeros(n)
    first = n - sum(dofs.count for dofs in rigid.values())
    for load in loads:
        if load.body in rigid:
            own = rigid[load.body]
            total[own.offset : own.offset + own.count] += own.force(load)
            continue
        dofs = bodies[load.body]
        if isinstance(load, RigidFooting):
            place = first - len(footings) + footings.index(_unloaded(load))
            total[place] += load.pressure * _area(dofs, _facets(dofs, load))
        elif isinstance(load, PointForce):
            vertex = vertex_at(dofs.body, load.at, "PointForce.at")
            nodes = dofs.vertex_nodes(vertex)  # where velocities jump, on their mean
            total[dofs.dofs[:, nodes]] += np.reshape(load.vector, (2, 1)) / nodes.size
        else:
            force = _distributed(load, dofs)
            total[dofs.offset : dofs.offset + force.size] += force
    return total


def _distributed(load: Traction | Pressure | BodyForce, dofs: BodyDofs) -> Floats:
    mesh = dofs.body.mesh
    centre = np.zeros(2)
    if isinstance(load, BodyForce):
        basis = Basis(mesh, dofs.basis.elem, intorder=_load_order(dofs))
    else:
        basis, centre = _facet_basis(dofs, _facets(dofs, load))

    @LinearForm
    def power(v, w):  # type: ignore[no-untyped-def]
        vector = -load.value * w.n if isinstance(load, Pressure) else load.vector
        places = w.x + centre[:, None, None]
        return dofs.body.thickness(places) * (vector[0] * v[0] + vector[1] * v[1])

    return np.asarray(power.assemble(basis))


def _load_order(dofs: BodyDofs) -> int:
    curved = is_curved(dofs.body.mesh) or dofs.body.axisymmetric
    return _CURVED_ORDER if curved else _LOAD_ORDER


def _facet_basis(dofs: BodyDofs, facets: Ints) -> tuple[FacetBasis, Floats]:
    """Of a part of the boundary, in coordinates from a centre, and that centre.

    Maps that are not affine are inverted to a fixed 1e-12, which far from the origin is below the
    round-off of coordinates.
    """
    mesh, centre = dofs.body.mesh, np.zeros(2)
    if is_curved(mesh) or not isinstance(mesh, MeshTri1):
        centre = mesh.doflocs.mean(axis=1)
        mesh = replace(mesh, doflocs=mesh.doflocs - centre[:, None])
    order = _load_order(dofs)
    return FacetBasis(mesh, dofs.basis.elem, facets=facets, intorder=order), centre


def _area(dofs: BodyDofs, facets: Ints) -> float:
    """Of a part of the boundary, m^2; m per unit thickness."""
    basis, centre = _facet_basis(dofs, facets)
    places = np.asarray(basis.global_coordinates()) + centre[:, None, None]
    return float(np.sum(basis.dx * dofs.body.thickness(places)))


def _facets(dofs: BodyDofs, part: Traction | Pressure | RigidFooting | Fix) -> Ints:
    return boundary_facets(dofs.body, part.where, f"{type(part).__name__}.where")


def _footings(problem: Problem) -> list[RigidFooting]:
    """The footings of all loads, each once whatever its pressure."""
    loads = [*problem.reference_loads, *problem.dead_loads]
    return list(dict.fromkeys(_unloaded(load) for load in loads if isinstance(load, RigidFooting)))


def _unloaded(footing: RigidFooting) -> RigidFooting:
    return replace(footing, pressure=1.0)


def _load_size(load: Floats, node_dofs: Ints) -> float:
    """Sum of the magnitudes of all nodal, footing, block and frame forces, N/m."""
    nodal = np.linalg.norm(load[node_dofs], axis=0).sum()
    return float(nodal + fsum(np.abs(load[node_dofs.size :])))


def _boundary_nodes(dofs: BodyDofs, facets: Ints) -> tuple[Ints, Floats]:
    """Nodes on facets, a each, and the outward normal there: (a n,), (a n, 2)."""
    nodes = dofs.facet_nodes(facets)
    shares = np.linspace(0.0, 1.0, len(nodes))
    outward = [outward_normals(dofs.body, facets, s).T for s in shares]
    return nodes.ravel() + dofs.first_node, np.concatenate(outward)


def _support_conditions(support: Fix, dofs: BodyDofs, slip: Slip | None) -> NodeConditions:
    facets = _facets(dofs, support)
    if support.components in ("normal", "tangential"):
        _require_straight(support, dofs, facets)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(-1))
    return support_conditions(support, *_boundary_nodes(dofs, facets))


def _require_straight(support: Fix, dofs: BodyDofs, facets: Ints) -> None:
    """Refuse polygons in place of arcs: two normals at each vertex would pin it."""
    start, *_, end = dofs.facet_nodes(facets)
    outward = [outward_normals(dofs.body, facets, s).T for s in (0.0, 1.0)]
    nodes, normals = np.concatenate([start, end]), np.concatenate(outward)
    order = np.argsort(nodes, kind="stable")
    same = nodes[order][1:] == nodes[order][:-1]
    cosine = np.sum(normals[order][1:] * normals[order][:-1], axis=1)[same]
    if np.any((cosine < _STRAIGHT) & (cosine > _CORNER)):
        raise InputError(
            "Fix.components",
            support.components,
            "its boundary turns by small angles, like a polygon in place of an arc: with two"
            " normals at a vertex, no velocity would be left there",
            "fix straight parts one by one, or the components x and y",
        )


def _footing_conditions(
    footing: RigidFooting, dofs: BodyDofs, slip: Slip | None, number: int
) -> NodeConditions:
    facets = _facets(dofs, footing)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(number))
    return footing_conditions(footing, *_boundary_nodes(dofs, facets), number)
