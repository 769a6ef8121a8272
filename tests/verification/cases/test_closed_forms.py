"""Each closed form at random parameters: certified, and within the band of its case."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.case import Variant
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.verdicts.words import PASS
from lacore_verification.runs.run import Run

BLOCK = {"W": (0.2, 5.0), "b": (0.5, 5.0), "h": (0.3, 3.0)}
FRAME = {"Mp": (0.2, 5.0), "h": (0.5, 4.0), "L": (1.0, 8.0)}
RANGES = {
    "block-between-walls": {"mu": (0.05, 1.5), **BLOCK},
    "block-incline": {"mu": (0.05, 1.5), "beta": (0.0, 1.2), **BLOCK, "down": bool},
    "block-incline-horizontal": {"mu": (0.05, 1.5), "beta": (0.0, 1.2), **BLOCK},
    "block-incline-vertical": {"mu": (0.05, 1.5), "beta": (0.05, 1.2), "H": (0.0, 2.0), **BLOCK},
    "block-slide": {"mu": (0.05, 1.5), **BLOCK, "y": (0.05, 3.0)},
    "block-topple": {"mu": (0.05, 1.5), **BLOCK},
    "deformable-block": {"mu": (0.05, 1.2)},
    "frame-feet": {"mu": (0.0, 1.0), **FRAME},
    "mortar-incline": {
        "mu": (0.05, 1.5),
        "adhesion": (0.0, 5.0),
        "share": (0.0, 1.0),
        "beta": (0.0, 1.2),
        **BLOCK,
        "off": bool,
    },
    "portal-beam": {"mu": (0.05, 1.0), "P": (0.0, 5.0), **FRAME},
    "portal-n-m": {"P": (0.1, 5.0), "Np": (5.0, 20.0), **FRAME},
    "portal-sway": {"mu": (0.05, 1.0), "P": (0.1, 5.0), **FRAME},
    "pulled-under-stop": {
        "mu1": (0.05, 1.0),
        "mu2": (0.05, 1.0),
        "mu_w": (0.0, 0.9),
        "W1": (0.5, 5.0),
        "W2": (0.2, 2.0),
    },
    "stack-n": {
        "n": int,
        "mu_1": (0.05, 1.0),
        "mu_n": (0.05, 1.0),
        "b": (0.5, 4.0),
        "h": (0.2, 2.0),
    },
    "stack-two": {
        "mu1": (0.05, 1.0),
        "mu2": (0.05, 1.0),
        "W1": (0.2, 5.0),
        "W2": (0.2, 5.0),
        "b": (1.0, 6.0),
        "h": (0.3, 2.0),
        "lower": bool,
    },
    "symmetric-wedge": {
        "mu": (0.05, 0.9),
        "mu_f": (0.05, 0.9),
        "beta": (0.02, 0.8),
        "W": (0.2, 5.0),
        "Wb": (0.5, 5.0),
    },
    "wedge-extraction": {
        "mu": (0.1, 0.9),
        "mu_f": (0.05, 0.9),
        "beta": (0.02, 0.6),
        "W": (0.2, 5.0),
        "Wb": (0.5, 5.0),
    },
    "wedge-in-walls": {"mu": (0.05, 1.0), "beta": (0.02, 0.8), "W": (0.2, 5.0), "down": bool},
}
PLUGS = RANGES["symmetric-wedge"] | {"beta": (0.0, 0.0)}
FEW, MANY = 3, 20  # sets of parameters: of the fast tests, and with the slow ones
KINDS = [*RANGES.items(), ("symmetric-wedge", PLUGS)]
NAMES = [*RANGES, "plug"]


def drawn(random, ranges):
    """One value of each parameter: bool, a small int, or uniform between two ends."""
    values = {}
    for name, kind in ranges.items():
        if kind is bool:
            values[name] = bool(random.integers(2))
        elif kind is int:
            values[name] = int(random.integers(1, 8))
        else:
            values[name] = float(random.uniform(*kind))
    return values


def samples(case_id, ranges, count):
    """Parameters for which the closed form holds: those outside of its range are drawn again."""
    case, random = catalogue()[case_id], np.random.default_rng(20)
    found = []
    while len(found) < count:
        values = drawn(random, ranges)
        if case.valid is None or case.valid(**values):
            found.append(values)
    return found


def wrong_ones(case_id, ranges, backend, coupling, count=MANY):
    """Texts of the runs that do not pass."""
    case = catalogue()[case_id]
    mesh = next(iter(case.meshes))
    runs = [
        Run(case, Variant(f"random-{n}", values), mesh, backend, coupling)
        for n, values in enumerate(samples(case_id, ranges, count))
    ]
    return [
        f"{outcome.run.variant.parameters}: {outcome.row.why}"
        for outcome in run_here(runs)
        if outcome.row.verdict != PASS
    ]


@pytest.mark.parametrize(("case_id", "ranges"), KINDS, ids=NAMES)
def test_closed_form_at_random_parameters(case_id, ranges):
    assert not wrong_ones(case_id, ranges, "clarabel", None, FEW)


@pytest.mark.slow
@pytest.mark.parametrize(("case_id", "ranges"), KINDS, ids=NAMES)
def test_closed_form_at_more_parameters(case_id, ranges):
    assert not wrong_ones(case_id, ranges, "clarabel", None)


@pytest.mark.parametrize(
    ("case_id", "ranges"),
    [
        ("block-between-walls", RANGES["block-between-walls"]),
        ("block-incline-vertical", RANGES["block-incline-vertical"]),
        ("wedge-extraction", RANGES["wedge-extraction"]),
        ("wedge-in-walls", RANGES["wedge-in-walls"]),
    ],
)
def test_associated_load_that_differs(case_id, ranges):
    assert not wrong_ones(case_id, ranges, "clarabel", "associated", FEW)


@pytest.mark.slow
@pytest.mark.parametrize("coupling", [None, "associated"])
@pytest.mark.parametrize(("case_id", "ranges"), KINDS, ids=NAMES)
def test_closed_form_by_linear_programs(case_id, ranges, coupling):
    if catalogue()[case_id].meshed:
        pytest.skip("a continuum is no linear program")
    assert not wrong_ones(case_id, ranges, "highs", coupling)


@pytest.mark.parametrize(
    ("case_id", "ranges"),
    [
        ("pulled-under-stop", RANGES["pulled-under-stop"] | {"mu_w": (0.05, 0.9)}),
        ("symmetric-wedge", PLUGS),
        ("block-between-walls", RANGES["block-between-walls"]),
    ],
    ids=["pulled-under-stop", "plug", "block-between-walls"],
)
@pytest.mark.parametrize("count", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_interval_has_the_ends_of_the_closed_form(case_id, ranges, count):
    """To 1e-6 of the load or of the dead loads, the bar of the certificate that proves them."""
    case = catalogue()[case_id]
    for values in samples(case_id, ranges, count):
        reference, band = case.reference(**values), case.band(0, **values)
        found = la.solve(case.build(**values), throw=True).interval()
        assert found.exact, values
        assert abs(found.low - reference.low) <= 1e-6 * band.size(reference.low), values
        if reference.high < np.inf:
            assert abs(found.high - reference.high) <= 1e-6 * band.size(reference.high), values
        else:
            assert found.high == np.inf
