"""Tractions along held sides, soils that vary, arcs and polygons as `lacore fuzz` judges them."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore_verification.fuzz.checks.bounds import wrong_bounds, wrong_safety
from lacore_verification.fuzz.checks.polygons import enclosing, examine_polygons
from lacore_verification.fuzz.checks.state_checks import check_state
from lacore_verification.fuzz.continua.soils import plastic_power, sides
from lacore_verification.fuzz.drawn.cases import draw
from lacore_verification.fuzz.drawn.copies import COPIES
from lacore_verification.fuzz.drawn.draw_continua import _continuum
from lacore_verification.fuzz.drawn.recipe import Soil, build, copied
from lacore_verification.fuzz.solving import answer


def rng():
    return np.random.default_rng(1)


def held_and_pulled(traction, driven=False):
    """A block held below, against a smooth wall on its left, with a traction along the bottom."""
    body = _continuum(rng(), "plane_strain", (0, 1), (0, 1), "p2-vertex")
    body["mesh"].update(nx=2, ny=2, cut="crossed")
    held = {"body": "block", "where": "bottom"}
    push = {"load": "RigidFooting", **held, "direction": [1.0, 0.0], "rough": True}
    pull = {"load": "BodyForce", "body": "block", "vector": [1.0, 0.0]}
    return {
        "bodies": {"block": body | {"strength": 1.0}},
        "reference": [push if driven else pull],
        "dead": [{"load": "Traction", **held, "vector": [traction, 0.0]}],
        "supports": [] if driven else [{**held, "components": "xy"}],
        "interfaces": [{"slave": ["block", "left"], "master": None, "friction": "smooth"}],
    }


@pytest.mark.parametrize("traction", [0.0, 0.9, -3.0])
def test_a_traction_on_a_support_past_which_a_body_slips(traction):
    found = answer(held_and_pulled(traction), rng())
    assert found.solved
    assert "block" in found.state.discretisation.slips
    assert found.wrong is None
    assert found.load_factor == pytest.approx(1.0, rel=1e-5)


def test_a_traction_that_acts_on_the_body_instead_is_noticed():
    recipe = held_and_pulled(0.9)
    found = answer(recipe, rng())
    without = replace(found.state, discretisation=replace(found.state.discretisation, slips={}))
    checks = [wrong.check for wrong in check_state(recipe, found.problem, without, rng())]
    assert "virtual power" in checks


def soil(**given):
    cuts = {"tension": None, "crushing": None, **given}
    slopes = {name: [0.1, 0.0] for name in ("cohesion", "angle", "tension", "crushing")}
    mesh = {"map": [[1.0, 0.0], [0.0, 1.0]], "shift": [0.0, 0.0]}
    return Soil({"strength": 2.0, "soil": {"angle": 30.0, "slopes": slopes, **cuts}, "mesh": mesh})


@pytest.mark.parametrize("cuts", [{}, {"tension": 0.5}, {"tension": 0.5, "crushing": 0.8}])
def test_the_power_of_a_soil_is_the_largest_of_all_stresses(cuts):
    corners = np.zeros((2, 1, 3))
    surface = sides(soil(**cuts), corners, np.max)
    mean, radius = np.meshgrid(np.linspace(-40, 4, 2201), np.linspace(0, 10, 501))
    inside = radius <= (surface.apex - mean) * surface.sine
    inside &= (mean + radius <= surface.tension) & (radius - mean <= surface.crushing)
    for growth, shear in ((1.0, 0.5), (1.0, 1.5), (1.0, 2.0)):
        most = np.max((mean * growth + radius * shear)[inside])
        found = plastic_power(surface, np.array([[growth]]), np.array([[shear]])).item()
        assert found == pytest.approx(most, rel=0.02)


@pytest.mark.parametrize("name", ["turned", "mirrored", "resized", "in other units"])
def test_a_soil_whose_strength_and_weight_vary_in_a_copy(name):
    recipe = draw("soils", 9200, 10)
    assert "growth" in recipe["reference"][0]
    other = answer(COPIES[name](recipe, rng()), rng())
    assert other.wrong is None
    assert other.load_factor == pytest.approx(answer(recipe, rng()).load_factor, rel=1e-4)


def test_an_upper_bound_below_the_lower_one_is_noticed():
    recipe = draw("arcs", 9200, 12)
    found = answer(recipe, rng())
    assert not list(wrong_bounds(found, 1.0))
    lower = la.lower_bound(found.problem).load_factor
    wrong = replace(found, state=replace(found.state, load_factor=lower * 0.9))
    assert found.state.rigor is la.Rigor.UPPER
    assert [one.check for one in wrong_bounds(wrong, 1.0)] == ["bounds"]


def test_a_safety_factor_that_is_too_large_is_noticed(monkeypatch):
    recipe = held_and_pulled(0.0)
    assert not list(wrong_safety(recipe, rng()))
    exact = la.safety_factor
    monkeypatch.setattr(
        la,
        "safety_factor",
        lambda *words, **named: replace(exact(*words, **named), lower=1.1, upper=1.2),
    )
    assert "safety factor" in [one.check for one in wrong_safety(recipe, rng())]


def test_polygons_of_sections_enclose_the_load_factor():
    recipe = draw("sections", 9200, 1)
    found = examine_polygons(recipe)
    assert found.wrong is None
    assert found.lower <= found.upper <= found.lower * 1.001
    stronger = copied(recipe) | {"dead": []}
    weaker = copied(stronger)
    for dimensions in stronger["bodies"]["frame"]["sections"].values():
        dimensions[2] *= 2.0
    assert enclosing(stronger, True) == pytest.approx(2 * enclosing(weaker, True))


def test_polygons_that_claim_the_other_side_are_noticed(monkeypatch):
    rectangle = la.sections.rectangle
    other = {"inner": "outer", "outer": "inner"}
    monkeypatch.setattr(
        la.sections,
        "rectangle",
        lambda *words, polygon: rectangle(*words, layers=2, polygon=other[polygon]),
    )
    assert examine_polygons(draw("sections", 9200, 1)).wrong is not None


def test_a_soil_is_drawn_as_it_is_stated():
    recipe = draw("soils", 9200, 0)
    body = build(recipe).bodies["block"]
    own = Soil(recipe["bodies"]["block"])
    places = np.array([[0.3], [0.4]])
    assert np.asarray(own.at("cohesion", places)) == pytest.approx(
        body.criterion.cohesion.at(places, "cohesion")
    )
