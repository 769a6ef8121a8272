"""Soil beside von Mises: the same mesh, loads and space, from the problem to the certificate.

No time is asserted: machines differ. What both are is asserted, and their ratio is told.
"""

import time
from dataclasses import replace

import pytest

import lacore as la
from lacore_verification.cases import (
    circular_footing_tresca,
    platens_soil,
    slope_phi,
    strip_footing,
    vertical_cut_phi,
)
from tests.benchmarks.measuring import dear

ROUNDS = 3  # in turns, so that what else the machine does meets both alike
SOILS = {
    "strip footing, 20 degrees": (strip_footing, "phi-20", None),
    "strip footing, 20 degrees, cut-off": (strip_footing, "phi-20", 0.2),
    "strip footing, 30 degrees": (strip_footing, "phi-30", None),
    "platens, 30 degrees": (platens_soil, "associated", None),
    "vertical cut, 20 degrees": (vertical_cut_phi, "phi-20", None),
    "slope": (slope_phi, "steep", None),
    "round footing, Tresca": (circular_footing_tresca, "smooth", None),
    "round footing, 20 degrees": (circular_footing_tresca, "phi-20", None),
    "round footing, 20 degrees, cut-off": (circular_footing_tresca, "phi-20", 0.2),
}


def built(case, variant, cutoff, size):
    """The problem of a case on a mesh, and with von Mises in place of its soil."""
    own = next(one for one in case.CASE.variants if one.name == variant)
    problem = case.build(**case.CASE.meshes[size], **own.parameters)
    ((name, body),) = problem.bodies.items()
    if cutoff is not None:
        body = replace(body, criterion=replace(body.criterion, tension_cutoff=cutoff))
    metal = replace(body, criterion=la.VonMises(shear_strength=1.0))
    return tuple(replace(problem, bodies={name: one}) for one in (body, metal))


@pytest.mark.slow
@pytest.mark.parametrize("size", dear(["medium", "fine"], ["fine"]))
@pytest.mark.parametrize("name", SOILS, ids=lambda name: name.replace(", ", "-").replace(" ", "-"))
@pytest.mark.benchmark(group="soil")
def test_soil(benchmark, one_thread, name, size):
    problems = built(*SOILS[name], size)
    seconds, states = ([], []), [None, None]

    def both():
        for place, problem in enumerate(problems):
            begin = time.process_time()
            states[place] = la.solve(problem, throw=False)
            seconds[place].append(time.process_time() - begin)

    benchmark.pedantic(both, rounds=ROUNDS, warmup_rounds=1)
    (soil, metal), (own, beside) = states, map(min, seconds)
    (body,) = problems[0].bodies.values()
    benchmark.extra_info.update(
        kind="soil",
        what=name,
        triangles=body.mesh.nelements,
        unknowns=soil.discretisation.program.n,
        seconds=own,
        ratio=own / beside,
        iterations=int(soil.history["inner_iterations"].sum()),
        beside=int(metal.history["inner_iterations"].sum()),
        largest=soil.certificate.worst[1],
    )
    assert soil.status is metal.status is la.Status.SOLVED, soil.message
