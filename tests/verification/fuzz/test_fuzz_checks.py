"""Errors planted in certified states: the checks of `lacore fuzz` notice each of them."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore_verification.fuzz.checks.state_checks import check_state
from lacore_verification.fuzz.drawn.cases import draw, random_of
from lacore_verification.fuzz.drawn.recipe import build

# How many of each class: the first that are certified, with shear in their contacts, or without.
SHEARED = {"blocks": 2, "mixtures": 1, "two-bodies": 1, "frames": 1}
CONTINUA = {"plane-strain": 1, "plane-stress": 1, "axisymmetric": 1}
MOST = 40  # problems that are looked at


@pytest.fixture(scope="module")
def solved():
    known = {}

    def of(kind, place):
        if kind not in known:
            known[kind] = certified(kind)
        return next(one for n, one in enumerate(known[kind].values()) if n == place)

    def certified(kind):
        found = {}
        for number in range(MOST):
            recipe = draw(kind, 1, number)
            if kind == "frames" and not recipe["interfaces"]:
                continue
            try:
                problem = build(recipe)
                state = la.solve(problem)
            except la.InputError:
                continue
            if state.status is la.Status.SOLVED and (kind in CONTINUA or sheared(state)):
                found[number] = recipe, problem, state
            if len(found) == (SHEARED | CONTINUA)[kind]:
                return found
        pytest.fail(f"too few problems of {kind} are certified")

    return of


def sheared(state):
    """Whether friction does not balance itself, as the thrusts on the feet of a frame do."""
    table = state.reactions
    return abs(table["t_t"].sum()) > 1e-2 * table["t_n"].max()


def seen(kind, recipe, problem, state):
    """Names of the checks that fail."""
    return {wrong.check for wrong in check_state(recipe, problem, state, random_of(kind, 1, 0))}


def planted(state, **given):
    """A state with parts of it replaced; its load factor stays what it claims."""
    return replace(state, point=replace(state.point, **given))


CASES = [(kind, place) for kind, count in (SHEARED | CONTINUA).items() for place in range(count)]


@pytest.mark.parametrize(("kind", "number"), CASES)
def test_a_certified_state_passes_and_a_wrong_number_does_not(solved, kind, number):
    recipe, problem, state = solved(kind, number)
    assert state.status is la.Status.SOLVED
    assert not seen(kind, recipe, problem, state)
    raised = replace(state, load_factor=state.load_factor * 1.001 + 1e-3)
    assert seen(kind, recipe, problem, raised)


@pytest.mark.parametrize(("kind", "number"), [c for c in CASES if c[0] in SHEARED])
def test_friction_of_the_other_sign(solved, kind, number):
    recipe, problem, state = solved(kind, number)
    turned = planted(state, tangential_reaction=-state.point.tangential_reaction)
    assert np.any(state.point.tangential_reaction)
    assert seen(kind, recipe, problem, turned)


@pytest.mark.parametrize(("kind", "number"), CASES)
def test_a_mechanism_of_the_other_sign(solved, kind, number):
    recipe, problem, state = solved(kind, number)
    back = planted(state, velocity=-state.point.velocity)
    assert seen(kind, recipe, problem, back)


@pytest.mark.parametrize(("kind", "number"), [c for c in CASES if c[0] in CONTINUA])
def test_stresses_that_are_a_thousandth_too_large(solved, kind, number):
    recipe, problem, state = solved(kind, number)
    larger = planted(state, stress=tuple(1.001 * part for part in state.point.stress))
    assert seen(kind, recipe, problem, larger)


@pytest.mark.parametrize(("kind", "number"), [c for c in CASES if c[0] in CONTINUA])
def test_a_dead_load_that_is_left_out(solved, kind, number):
    recipe, problem, state = solved(kind, number)
    extra = {"load": "BodyForce", "body": "block", "vector": [0.0, -1e-2 * _strength(recipe)]}
    heavier = {**recipe, "dead": [*recipe["dead"], extra]}
    assert {"virtual power", "balance of a continuum"} & seen(kind, heavier, problem, state)


def _strength(recipe):
    return recipe["bodies"]["block"]["strength"]


def test_the_reaction_of_a_block_that_weighs_next_to_nothing():
    """A stone of 1e-8 of the wall: its reaction doubled is 1e-8 of all forces, and is seen."""
    heavy, light = [[-3, -1], [6, -1], [6, 0], [-3, 0]], [[1, 0], [2, 0], [2, 1], [1, 1]]
    recipe = {
        "bodies": {
            "wall": {
                "kind": "blocks",
                "polygons": {
                    "base": heavy,
                    "wall": [[-2, 0], [0, 0], [0, 1], [-2, 1]],
                    "stone": light,
                },
                "friction": 0.3,
                "joints": [],
            }
        },
        "reference": [{"load": "BodyForce", "body": "wall", "vector": [1.0, 0.0], "where": "wall"}],
        "dead": [
            {"load": "BodyForce", "body": "wall", "vector": [0.0, -1.0], "where": "wall"},
            {"load": "BodyForce", "body": "wall", "vector": [0.0, -1e-8], "where": "stone"},
        ],
        "supports": [{"body": "wall", "where": "base"}],
        "interfaces": [],
    }
    problem = build(recipe)
    state = la.solve(problem)
    table = state.reactions
    of_stone = table["interface"].str.contains("stone").to_numpy()
    assert of_stone.any()
    exact = state.point.normal_reaction.copy()
    exact[of_stone] = 0.5e-8 / table["length"].to_numpy()[of_stone]
    shear = state.point.tangential_reaction.copy()
    shear[of_stone] = 0.0
    right = planted(state, normal_reaction=exact, tangential_reaction=shear)
    assert "balance of a block" not in seen("weights", recipe, problem, right)
    twice = planted(
        state, normal_reaction=np.where(of_stone, 2 * exact, exact), tangential_reaction=shear
    )
    assert "balance of a block" in seen("weights", recipe, problem, twice)
