"""Small programs of random numbers: laws are tested on them without any mesh."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix

from lacore.program.kinematic import ContactRows, DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces

N, CONES, POINTS = 9, 4, 3


def random_program(seed):
    """A program of nine unknowns, four cones of two rows, three contact points."""
    rng = np.random.default_rng(seed)

    def rows(count):
        return csr_matrix(rng.uniform(-1, 1, (count, N)))

    group = DissipationGroup(
        name="body",
        rows=rows(2 * CONES),
        dim=2,
        weights=rng.uniform(0.1, 1, CONES),
        bound=rng.uniform(0.5, 2, CONES),
        volumetric=rows(CONES),
        volumetric_factor=1 / np.sqrt(3),
    )
    contact = ContactRows(
        normal=rows(POINTS),
        tangential=rows(POINTS),
        tangent_dim=1,
        weights=rng.uniform(0.1, 1, POINTS),
        coefficient=rng.uniform(0.1, 1, POINTS),
        limit=rng.uniform(0, 1, POINTS),
        dilatancy=np.zeros(POINTS),
        interface=np.zeros(POINTS, dtype=int),
    )
    return KinematicProgram(
        groups=(group,),
        contact=contact,
        reference_load=rng.uniform(-1, 1, N),
        dead_load=rng.uniform(-1, 1, N),
    )


def random_step(seed):
    """`random_program` as a step of a path: some cones harden, the points have a way to go."""
    program, rng = random_program(seed), np.random.default_rng(seed + 1)
    (group,) = program.groups
    modulus = rng.uniform(0, 3, CONES) * (rng.uniform(size=CONES) > 0.3)
    closing = rng.uniform(0, 0.5, POINTS)
    return replace(
        program,
        groups=(replace(group, modulus=modulus),),
        contact=replace(program.contact, closing=closing),
        dead_load=0.05 * program.dead_load,  # any more collapses one in two
    )


def random_soil(seed):
    """`random_program` with cones that feel two volumetric rates: three planes, and one of p."""
    program, rng = random_program(seed), np.random.default_rng(seed + 2)
    (group,) = program.groups
    surfaces = Surfaces(
        slope=rng.uniform(-1, 1, (CONES, 4, 2)),
        strength=rng.uniform(0.5, 2, (CONES, 4)),
        normed=np.array([1.0, 1.0, 1.0, 0.0]),
        dilation=rng.uniform(-0.3, 0.3, 2 * CONES),
    )
    volumes = csr_matrix(rng.uniform(-1, 1, (2 * CONES, N)))
    soil = replace(group, volumetric=volumes, volumetric_factor=0.0, surfaces=surfaces)
    return replace(program, groups=(soil,))


def frozen(bound, dilatancy=0.0, shift=0.0):
    return FrozenContact(
        *(np.broadcast_to(np.asarray(v, float), POINTS).copy() for v in (bound, dilatancy, shift))
    )


def random_state(program, rng):
    """A state that is wrong in everything."""

    def drawn(*shape):
        return rng.uniform(-1, 1, shape)

    groups, points = program.groups, program.contact.count
    return ProgramState(
        velocity=drawn(program.n),
        load_factor=float(rng.uniform(-1, 1)),
        stress=tuple(drawn(group.weights.size, group.dim) for group in groups),
        mean_stress=tuple(drawn(group.weights.size * group.volumes) for group in groups),
        normal_reaction=drawn(points),
        tangential_reaction=drawn(points, program.contact.tangent_dim),
    )
