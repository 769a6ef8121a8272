"""What random paths are judged by: closed forms, friction, volume and the power of tools."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import lacore as la
from lacore.paths.stage import staged
from lacore_verification.fuzz.checks.path_copies import moved_back, same_load
from lacore_verification.fuzz.checks.path_facts import check_facts, exact_force
from lacore_verification.fuzz.checks.verdict import first
from lacore_verification.fuzz.drawn.cases import draw
from lacore_verification.fuzz.drawn.copies import COPIES, copied
from lacore_verification.fuzz.drawn.paths import follow
from lacore_verification.fuzz.drawn.recipe import build
from lacore_verification.fuzz.examine import examine
from lacore_verification.harness.campaigns.shrinking import candidates

PAIRS, TOOLS = "pairs-on-paths", "tools-on-paths"
KINDS = [PAIRS, TOOLS]


@cache
def recipe_with(fact):
    """The first recipe with a fact, with the smallest meshes."""
    kind = TOOLS if fact == "platens" else PAIRS
    recipe = next(own for own in (draw(kind, 1, n) for n in range(100)) if own.get("fact") == fact)
    made = copied(recipe)
    for body in made["bodies"].values():
        if body["kind"] == "continuum":
            body["mesh"].update(nx=1, ny=1)
    made["path"]["steps"] = 1
    return made


@cache
def path_with(fact):
    return follow(recipe_with(fact))


@pytest.mark.parametrize("fact", ["stack", "narrow", "sled", "platens"])
def test_a_right_path_keeps_its_facts(fact):
    assert first(check_facts(recipe_with(fact), path_with(fact))) is None


def stronger(recipe):
    recipe["bodies"]["block"]["strength"] *= 1.001


def smoother(recipe):
    recipe["interfaces"][0]["friction"] *= 0.99


def slower(recipe):
    recipe["path"]["tools"]["up"][1] *= 1.001


@pytest.mark.parametrize(
    ("fact", "change", "check"),
    [
        ("platens", stronger, "exact force of a path"),
        ("sled", smoother, "friction on a path"),
        ("platens", slower, "power of tools"),
    ],
)
def test_an_injected_error_is_found(fact, change, check):
    recipe = copied(recipe_with(fact))
    change(recipe)
    found = [wrong.check for wrong in check_facts(recipe, path_with(fact))]
    assert check in found


def test_a_path_that_ends_early_has_a_status_that_results_are_stored_with():
    recipe = copied(recipe_with("stack"))
    recipe["path"]["travel"] = 100.0
    found = examine(recipe, np.random.default_rng(1))
    assert found.status in {status.label for status in la.Status} - {"solved"}
    assert found.wrong is None
    assert found.message


def test_what_has_a_fact_is_cut_in_its_meshes_alone():
    recipe = draw(PAIRS, 1, next(n for n in range(100) if "fact" in draw(PAIRS, 1, n)))
    cut = list(candidates(recipe))
    assert cut
    assert all(own["interfaces"] == recipe["interfaces"] for own in cut)
    assert all(exact_force(own, 0.01) == exact_force(recipe, 0.01) for own in cut)


@pytest.mark.parametrize(
    ("fact", "name"), [("platens", "turned"), ("sled", "mirrored"), ("sled", "reordered")]
)
def test_a_copy_has_the_load_of_the_same_bodies(fact, name):
    copy = follow(COPIES[name](recipe_with(fact), np.random.default_rng(1)))
    assert first(same_load(name, path_with(fact), copy)) is None


def test_a_copy_with_other_friction_is_found():
    recipe = COPIES["mirrored"](recipe_with("sled"), np.random.default_rng(1))
    recipe["interfaces"][0]["friction"] *= 0.999
    found = first(same_load("mirrored", path_with("sled"), follow(recipe)))
    assert found is not None
    assert found.check == "mirrored, load on the same bodies"


def test_strains_of_a_mirrored_copy_are_those_of_the_same_places():
    """Quadrilaterals begin at another corner when they are mirrored."""
    recipe = copied(recipe_with("platens"))
    recipe["bodies"]["block"]["space"] = "q2"
    recipe["bodies"]["block"]["mesh"].update(nx=2, ny=2, cut="quads")
    copy = COPIES["mirrored"](recipe, np.random.default_rng(1))
    known, mirrored = (staged(build(own), ()) for own in (recipe, copy))
    x, of_copy = (
        np.asarray(own.dofs_at(own.start)["block"].basis.global_coordinates())[0]
        for own in (known, mirrored)
    )
    start = mirrored.start
    strained = replace(start, strain={**start.strain, "block": -of_copy})
    assert moved_back(strained, mirrored, known).strain["block"] == pytest.approx(x)


def test_a_turned_path_has_turned_tools():
    recipe = recipe_with("platens")
    made = COPIES["turned"](recipe, np.random.default_rng(1))
    for name, speed in recipe["path"]["tools"].items():
        assert np.linalg.norm(made["path"]["tools"][name]) == pytest.approx(np.linalg.norm(speed))
        assert made["path"]["tools"][name] != pytest.approx(speed)


def test_a_path_under_other_names_has_its_tools_under_them():
    recipe = recipe_with("platens")
    made = COPIES["renamed"](recipe, np.random.default_rng(1))
    assert set(made["path"]["tools"]) < set(made["bodies"])
    exact = exact_force(recipe, recipe["path"]["travel"])
    assert follow(made).history["force"].iloc[-1] == pytest.approx(exact, rel=1e-5)
