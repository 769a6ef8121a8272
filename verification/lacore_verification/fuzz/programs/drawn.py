"""Programs from random problems: bodies of every kind on meshes of a given fineness."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

import lacore as la
from lacore.bounds.static_model import static_model
from lacore.program.kinematic import (
    ContactRows,
    FrozenContact,
    KinematicProgram,
    associated_contact,
    dimensionless,
    family_contact,
    stick_contact,
)
from lacore.reporting.errors import InputError
from lacore_verification.fuzz.drawn import draw_blocks, draw_continua, draw_frames
from lacore_verification.fuzz.drawn.copies import with_law
from lacore_verification.fuzz.drawn.draw import Rng, chosen, number
from lacore_verification.fuzz.drawn.recipe import Recipe, build
from lacore_verification.fuzz.programs.chains import chains
from lacore_verification.fuzz.programs.made import assembly_in_space, grid_frame, solid, wall

_TRIES = 40  # Draws until lacore accepts one.
_FINEST = 200  # Cells along an edge.
_UNIT = ("plane_strain", "plane_strain", "plane_stress", "axisymmetric")


@dataclass(frozen=True)
class Drawn:
    """A program and the contact that is frozen for its solve."""

    program: KinematicProgram
    contact: FrozenContact


Family = Callable[[Rng, int], Drawn]


def of_problem(problem: la.Problem, rng: Rng) -> Drawn:
    """Return the program that upper bounds and loops solve."""
    made = la.discretise(problem)
    program = dimensionless(made.program.associated(), made.natural)
    return Drawn(program, frozen_at_random(program.contact, rng))


def frozen_at_random(contact: ContactRows, rng: Rng) -> FrozenContact:
    """Return contact frozen as in loops.

    Associated, sticking, or friction with random reactions.
    """
    kind = rng.integers(4)
    if kind == 0:
        return associated_contact(contact)
    if kind == 1:
        return stick_contact(contact)
    # Smooth along the contact, as reactions are, and zero at some points.
    wave = np.cumsum(rng.normal(size=contact.count)) / np.sqrt(max(contact.count, 1))
    reaction = number(rng, 0.1, 2.0) * np.maximum(0.3 + wave, 0.0)
    if kind == 2:
        return family_contact(contact, 0.0, reaction, np.zeros(contact.count))
    share = float(chosen(rng, (1.0, number(rng, 0.05, 1.0))))
    slip = np.abs(rng.normal(size=contact.count)) * (rng.uniform(size=contact.count) > 0.5)
    return family_contact(contact, share, reaction, number(rng, 0.0, 0.3) * slip)


def meshed(recipe: Recipe, size: int, unknowns: Callable[[Recipe], int]) -> Recipe:
    """Return a recipe with meshes refined to about a given number of unknowns."""
    bodies = [body for body in recipe["bodies"].values() if body["kind"] == "continuum"]
    for _ in range(2):  # Edges matter less on finer meshes.
        factor = np.sqrt(size / max(unknowns(recipe), 1))
        for body in bodies:
            for axis in ("nx", "ny"):
                cut = round(body["mesh"][axis] * factor)
                body["mesh"][axis] = int(np.clip(cut, 1, _FINEST))
    return recipe


def from_recipe(recipe_of: Callable[[Rng], Recipe], rng: Rng, size: int) -> Drawn:
    """Return the program of a recipe of a class of random problems."""
    recipe = meshed(recipe_of(rng), size, lambda own: int(la.discretise(build(own)).program.n))
    return of_problem(build(recipe), rng)


def of_soils(rng: Rng, size: int) -> Drawn:
    """Return a body of soil, rock, concrete or masonry, with the program of its upper bound."""
    recipe = draw_continua.one_body(rng, chosen(rng, _UNIT))
    recipe["bodies"]["block"]["space"] = chosen(rng, ("p2-vertex", "p2-gauss", "p1-disc"))
    if recipe["bodies"]["block"]["kinematics"] == "axisymmetric":
        recipe["bodies"]["block"]["space"] = "p2-gauss"
    if recipe["bodies"]["block"]["mesh"]["cut"] == "quads":
        recipe["bodies"]["block"]["mesh"]["cut"] = "crossed"
    earth = material(rng, recipe["bodies"]["block"]["kinematics"])

    def problem(own: Recipe) -> la.Problem:
        return _of_material(build(own), earth)

    recipe = meshed(recipe, size, lambda own: int(la.discretise(problem(own)).program.n))
    return of_problem(problem(recipe), rng)


def from_below(rng: Rng, size: int, soil: bool) -> Drawn:
    """Return the program of a lower bound."""
    kinematics = "plane_strain" if rng.random() < 0.8 else "plane_stress"
    recipe = with_law(draw_continua.one_body(rng, kinematics), "associated")
    block = recipe["bodies"]["block"]
    block["space"] = "p2-vertex"
    block["mesh"]["cut"] = chosen(rng, ("crossed", "diagonal"))
    earth = material(rng, kinematics) if soil else None

    def problem(own: Recipe) -> la.Problem:
        made = build(own)
        return made if earth is None else _of_material(made, earth)

    recipe = meshed(recipe, size, lambda own: int(static_model(problem(own)).program.n))
    model = static_model(problem(recipe))
    program = dimensionless(model.program, model.natural)
    return Drawn(program, associated_contact(program.contact))


def hardening(rng: Rng, size: int) -> Drawn:
    """Return a step of a path: cones with hardening, contact with a gap."""
    drawn = from_recipe(partial(draw_continua.one_body, kinematics=chosen(rng, _UNIT)), rng, size)
    program, contact = drawn.program, drawn.program.contact
    closing = rng.uniform(0, 0.5, contact.count) * (rng.uniform(size=contact.count) > 0.5)
    groups = tuple(
        replace(group, modulus=_moduli(rng, group.weights.size)) for group in program.groups
    )
    moving = replace(contact, closing=closing)
    step = replace(program, groups=groups, contact=moving, dead_load=0.3 * program.dead_load)
    return Drawn(step, frozen_at_random(moving, rng))


def unsafe(rng: Rng, size: int) -> Drawn:
    """Return dead loads, most of which exceed the strength."""
    drawn = DRAWN[chosen(rng, _CARRYING)](rng, size)
    program = drawn.program
    push = rng.normal(size=program.n) * np.abs(program.reference_load).max(initial=1.0)
    dead = program.dead_load + 10.0 ** float(rng.uniform(0, 3)) * push
    return replace(drawn, program=replace(program, dead_load=dead))


def locked(rng: Rng, size: int) -> Drawn:
    """Return loads against obstacles, or against incompressible bodies."""
    drawn = DRAWN[chosen(rng, _CARRYING)](rng, size)
    program = drawn.program
    force = -program.contact.normal.T @ (
        program.contact.weights * rng.uniform(0, 1, program.contact.count)
    )
    for group in program.groups:
        if group.surfaces is None:
            mean = rng.normal(size=group.volumetric.shape[0])
            force = force + group.volumetric.T @ (group.volume_weights * mean)
    if not np.abs(force).max(initial=0.0) > 0:
        raise InputError("family", "locked", "nothing resists without strength", "draw again")
    size_of = np.abs(program.reference_load).sum() / np.abs(force).sum()
    dead = 0.01 * program.dead_load
    return replace(drawn, program=replace(program, reference_load=size_of * force, dead_load=dead))


def material(rng: Rng, kinematics: str) -> Any:
    """Return a criterion whose strength depends on pressure, most of them of several surfaces."""
    angle = number(rng, 5, 45)
    kind = rng.integers(6)
    cut = {} if rng.random() < 0.5 else {"tension_cutoff": 0.0}
    if rng.random() < 0.3:
        cut["crushing"] = number(rng, 3, 20)
    if kind == 0:
        return la.MohrCoulomb(1.0, angle)
    if kind == 1:
        return la.MohrCoulomb(1.0, angle, **cut)
    if kind == 2:
        return la.Rankine(number(rng, 0.0, 0.5), number(rng, 1, 10))
    if kind == 3:
        return la.NoTension(number(rng, 1, 10))
    if kind == 4:
        return la.MaximumShear(1.0)
    match = "plane_strain" if kinematics == "plane_strain" else "compression"
    return la.DruckerPrager(1.0, min(angle, 20.0), match)


def draw_program(family: str, seed: int, place: int, size: int) -> Drawn:
    """Return program number `place` of a family, of about `size` unknowns.

    Raises:
        InputError: none of the random problems was valid.
    """
    rng = np.random.default_rng([seed, place, *family.encode()])
    for _ in range(_TRIES):
        try:
            drawn = DRAWN[family](rng, size)
        except (la.InputError, la.CapabilityError):
            continue
        if np.abs(drawn.program.reference_load).max(initial=0.0) > 0:
            return drawn
    raise InputError("family", family, f"no problem in {_TRIES} draws", "take another seed")


def _of_material(problem: la.Problem, earth: Any) -> la.Problem:
    bodies = {
        name: la.Body(body.mesh, earth, kinematics=body.kinematics, space=body.space)
        for name, body in problem.bodies.items()
        if isinstance(body, la.Body)
    }
    return replace(problem, bodies=bodies)


def _moduli(rng: Rng, count: int) -> Any:
    rise = 10.0 ** float(rng.uniform(-2, 1))
    return rise * rng.uniform(0, 1, count) * (rng.uniform(size=count) > 0.2)


def _of_made(make: Callable[[Rng, int], la.Problem], rng: Rng, size: int) -> Drawn:
    return of_problem(make(rng, size), rng)


def _of_chain(rng: Rng, size: int) -> Drawn:
    return Drawn(*chains(rng, size))


def _small(recipe_of: Callable[[Rng], Recipe], rng: Rng, size: int) -> Drawn:
    return of_problem(build(recipe_of(rng)), rng)


DRAWN: Mapping[str, Family] = {
    "plane strain": partial(from_recipe, draw_continua.plane_strain),
    "plane stress": partial(from_recipe, draw_continua.plane_stress),
    "of revolution": partial(from_recipe, draw_continua.axisymmetric),
    "two bodies": partial(from_recipe, draw_continua.two_bodies),
    "body and blocks": partial(from_recipe, draw_continua.mixtures),
    "from below": partial(from_below, soil=False),
    "soil": of_soils,
    "soil from below": partial(from_below, soil=True),
    "in space": partial(_of_made, solid),
    "walls": partial(_of_made, wall),
    "blocks in space": partial(_of_made, assembly_in_space),
    "weights": partial(_small, draw_blocks.weights),
    "frames": partial(_of_made, grid_frame),
    "portals": partial(_small, draw_frames.frames),
    "hardening": hardening,
    "chains": _of_chain,
    "unsafe": unsafe,
    "locked": locked,
}
"""Families by name; those of single blocks and portals have the size that they have."""
_CARRYING = ("plane strain", "of revolution", "two bodies", "soil", "walls", "chains")
