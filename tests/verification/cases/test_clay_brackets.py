"""Clay in layers and clay that grows stronger with depth: brackets of 1 % around references."""

import pytest

import lacore as la
from lacore_verification.case import Case, Variant
from lacore_verification.catalogue.catalogue import find

LAYERS = [("soft-below", 2.5), ("stiff-below", 1.5)]
"""Variants of `layered-clay`, and how deep their boxes are."""


def found(name: str) -> tuple[Case, Variant]:
    case, (variant,) = find(name)
    return case, variant


def enclosed(problem: la.Problem, case: Case, variant: Variant) -> la.Bracket:
    """A strict bracket of 1 % that meets the reference, from a mesh far from it."""
    bracket = la.bracket(problem, 0.01)
    reference = case.reference_of(variant)
    assert bracket.status is la.Ending.REACHED, bracket.message
    assert bracket.strict
    assert bracket.width <= 0.01
    assert bracket.lower <= reference.high
    assert reference.low <= bracket.upper
    return bracket


@pytest.mark.slow
@pytest.mark.parametrize(("name", "depth"), LAYERS)
def test_layers_are_regions_of_one_mesh_or_bonded_bodies(name, depth):
    case, variant = found(f"layered-clay:{name}")
    regions = case.problem_of(case.meshes["coarse"], variant.parameters)
    one = enclosed(regions, case, variant)
    body = regions.bodies["clay"]
    clay = {region.name: region.criterion for region in body.regions}
    width = float(body.mesh.p[0].max())
    layers = {"upper": (-0.5, 0.0), "lower": (-depth, -0.5)}
    bodies = {
        layer: la.Body(
            la.meshes.rectangle((0, width), y, round(6 * width), round(6 * (y[1] - y[0]))),
            clay[layer],
        )
        for layer, y in layers.items()
    }
    bonded = la.Problem(
        bodies,
        [la.RigidFooting("upper", lambda x: (x[0] <= 0.5) & (x[1] > -1e-9), (0, -1))],
        [
            *(la.Fix(layer, "left", "x") for layer in bodies),
            *(la.Fix(layer, "right") for layer in bodies),
            la.Fix("lower", "bottom"),
        ],
        [la.Interface(("upper", "bottom"), ("lower", "top"), la.BOND)],
    )
    other = enclosed(bonded, case, variant)
    assert max(one.lower, other.lower) <= min(one.upper, other.upper)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rough-1", "rough-4", "rough-16"])
def test_strength_that_rises_with_depth(name):
    """Davis and Booker (1973), by characteristics, at three ratios rho B/k0."""
    case, variant = found(f"strength-with-depth:{name}")
    enclosed(case.problem_of(case.meshes["coarse"], variant.parameters), case, variant)
