"""Assembly of 50 000 triangles against the solve of the same program, in one run.

Run with ``pytest --benchmark-only -m slow tests/benchmarks``. Neither time is asserted: machines
differ. The ratio is what the issue asks for, and is kept in the record of the benchmark.
"""

import time

import pytest

import lacore as la
from lacore.backend import find_backend
from lacore.program import dimensionless, reaction_contact

CELLS = 112  # crossed: 4 * 112^2 = 50 176 triangles


@pytest.fixture(scope="module")
def problem():
    mesh = la.meshes.rectangle(
        (0, 4), (-2, 0), CELLS, CELLS, grade_x=(1.0, 12.0), grade_y=(0.0, 24.0)
    )
    assert mesh.nelements == 50_176
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
            la.Fix("soil", "left", components="x"),
        ],
        reference_loads=[
            la.RigidFooting("soil", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), rough=False)
        ],
    )


@pytest.mark.slow
def test_assembly(benchmark, problem):
    d = benchmark.pedantic(la.discretise, args=(problem,), rounds=3, warmup_rounds=1)
    backend = find_backend("clarabel")
    program = dimensionless(d.program, d.natural)
    begin = time.perf_counter()
    answer = backend.prepare(program, backend.Options()).solve(
        reaction_contact(program.contact, program.contact.weights[:0])
    )
    solve = time.perf_counter() - begin
    benchmark.extra_info.update(
        triangles=problem.bodies["soil"].mesh.nelements,
        unknowns=d.program.n,
        clarabel_seconds=round(solve, 2),
        clarabel_iterations=answer.iterations,
        status=answer.status.label,
        assembly_over_solve=round(benchmark.stats.stats.median / solve, 4),
    )
    assert answer.point is not None
