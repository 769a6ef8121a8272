"""Texts of results are rendered once: nothing in the packages takes one apart, or looks into it."""

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
TEXTS = {"message", "why", "phrase", "report", "reason", "claim", "stopped", "failure", "note"}
SURGERY = {
    *("split", "rsplit", "splitlines", "partition", "rpartition", "replace", "translate"),
    *("removeprefix", "removesuffix", "strip", "lstrip", "rstrip", "startswith", "endswith"),
    *("find", "rfind", "index", "count", "sub", "match", "search", "fullmatch", "findall"),
}
CUT = {  # texts of others, shortened because they may be of any length
    ("lacore/solvers/contract.py", "answer.message[:_LONGEST_MESSAGE]"),
    ("verification/lacore_verification/commands/fuzz.py", "outcome.row.why[:160]"),
}


def texts_in(tree: ast.AST) -> set[str]:
    """Names of texts that an expression reads as attributes."""
    names = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    return names & TEXTS


def surgery(tree: ast.AST) -> Iterator[ast.expr]:
    """Expressions that take a text apart, or look for another text in it."""
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Attribute(value=value, attr=name), args=args):
                if name in SURGERY and any(map(texts_in, [value, *args])):
                    yield node
            case ast.Subscript(value=ast.Attribute(attr=name)) if name in TEXTS:
                yield node
            case ast.Compare(ops=ops, comparators=others):
                looks = any(isinstance(op, ast.In | ast.NotIn) for op in ops)
                if looks and any(isinstance(o, ast.Attribute) and o.attr in TEXTS for o in others):
                    yield node


def test_no_text_of_a_result_is_taken_apart():
    files = [path for own in ("lacore", "verification") for path in (ROOT / own).rglob("*.py")]
    assert files
    found = {
        (path.relative_to(ROOT).as_posix(), ast.unparse(node))
        for path in files
        for node in surgery(ast.parse(path.read_text(encoding="utf-8")))
    }
    assert found == CUT


def test_surgery_is_seen():
    wrong = (
        *("row.why.split(':')[0]", "worth(state).message.partition(':')", "x.message[3:]"),
        *("'solved' in state.message", "re.sub('a', 'b', row.why)", "a.report.notes.strip()"),
    )
    assert all(any(surgery(ast.parse(text))) for text in wrong)
    right = ("f'{row.why}: more'", "row.why == ''", "name.split(':')", "texts(found.findings)")
    assert not any(any(surgery(ast.parse(text))) for text in right)
