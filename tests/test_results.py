"""Results are built once: nothing replaces their status, load factor, rigour or findings later."""

import ast
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name

import pytest

import lacore as la
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Result

ROOT = Path(__file__).parents[1]
JUDGED = {
    *("status", "load_factor", "rigor", "findings", "message", "severity", "standing", "stop"),
    *("verdict", "why", "ray", "certificate"),
}
"""Fields that say what a result proves."""
POINTS = {  # a copy of a state of the program with the load factor that belongs to it
    *("lacore/program/projection.py", "lacore/coupling/claims/dead_loads.py"),
    "lacore/coupling/claims/locking_ray.py",
    *("lacore/coupling/blocks/slack.py", "lacore/limit/checking.py", "lacore/limit/outcome.py"),
    *("lacore/coupling/claims/carried.py", "lacore/limit/state.py"),
    "lacore/program/regularization.py",
    *("backends/lacore_backends/_conic_laws.py", "lacore/coupling/interval.py"),
    *("backends/lacore_backends/clarabel_regularised.py", "lacore/limit/interval.py"),
    "verification/lacore_verification/harness/evidence/path.py",
}
BUILDERS = {  # what builds a value in several steps, and is the only place that does
    "lacore/solvers/inner/rescaling.py": "answers of solvers, which it measures in several units",
    "lacore/solvers/contract.py": "answers of solvers, as far as they keep the contract",
    "backends/lacore_backends/interior_point.py": "its own answer, measured again",
    "lacore/paths/flow.py": "the load of a step that lasts longer",
    "lacore/analyses/ranges/coulomb.py": "the last iterate with the end of its mechanism",
    "verification/lacore_verification/harness/perform/bracket.py": "a row, which it judges",
    "verification/lacore_verification/harness/perform/path.py": "a row, which it judges",
    "verification/lacore_verification/harness/perform/ranging.py": "a row, which it judges",
    "verification/lacore_verification/harness/perform/worker.py": "a row, with a note",
    "verification/lacore_verification/conformance/suite.py": "findings, as sentences",
    "verification/lacore_verification/harness/campaigns/instances.py": "a useless minimum",
}


def replacements(tree: ast.AST) -> Iterator[ast.Call]:
    """Calls that copy a value with another status, load factor or another of `JUDGED`."""
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name("replace") | ast.Attribute(attr="replace" | "__setattr__")):
                if JUDGED & {keyword.arg for keyword in node.keywords}:
                    yield node
                if ast.unparse(node.func) == "object.__setattr__":
                    named = {own.value for own in node.args if isinstance(own, ast.Constant)}
                    if JUDGED & named:
                        yield node


def test_results_are_built_once():
    folders = ("lacore", "backends", "verification")
    files = [path for own in folders for path in (ROOT / own).rglob("*.py")]
    found = {
        path.relative_to(ROOT).as_posix()
        for path in files
        if any(replacements(ast.parse(path.read_text(encoding="utf-8"))))
    }
    assert found == POINTS | BUILDERS.keys()


def test_every_result_is_on_one_interface():
    """States, bounds, ranges, paths and the verdicts on them: also those that only compare."""
    for name in (
        *("coupling.interval:Interval", "limit.stability:Stability", "limit.state:LimitState"),
        *("analyses.stable:Stable", "bounds.bracket.crushing_bracket:CrushingBracket"),
        *("bounds.bracket.bracket:Bracket", "paths.path:Path", "paths.steady:SteadyState"),
    ):
        assert issubclass(resolve_name(f"lacore.{name}"), Result), name


def test_the_verdict_on_dead_loads_reports_as_states_do():
    column = la.examples.column()
    found = la.stable(column)
    assert found.status is la.Status.SOLVED
    assert found.findings[0].kind is Kind.DEAD_LOADS
    assert found.checked(throw=True) is found
    interval = la.solve(column).interval()
    assert interval.findings == ()  # plane: no slack of turning directions
    assert interval.message == ""


def test_replacements_are_seen():
    wrong = ("replace(bound, status=x)", "dataclasses.replace(a, findings=())")
    assert all(any(replacements(ast.parse(text))) for text in wrong)
    assert any(replacements(ast.parse("object.__setattr__(state, 'rigor', x)")))
    right = ("replace(body, mesh=mesh)", "text.replace('status', '')")
    assert not any(any(replacements(ast.parse(text))) for text in right)


def test_all_results_report_their_findings():
    """The text is that of the findings, whatever the result; a status without a point throws."""
    column = la.examples.column()
    results = [la.solve(column), la.load_cases(column, {"push": column.reference_loads})]
    for result in results:
        assert isinstance(result, Result)
        assert result.report.findings == result.findings
        assert result.message == str(result.report)
    free = la.solve(la.examples.column(friction=0.0))
    assert free.status is not la.Status.SOLVED
    with pytest.raises(la.SolveError, match=free.status.label):
        free.checked(throw=True)
    assert free.checked(throw=False) is free
    assert free.unanswered("any").kind is Kind.STATUS


@pytest.mark.parametrize("name", ["CoulombRange", "SoilRange"])
def test_names_of_ranges_before_they_were_one_still_work(name):
    with pytest.warns(DeprecationWarning, match=f"lacore.{name} is now lacore.LoadFactorRange"):
        assert getattr(la, name) is la.LoadFactorRange
