"""Generate errors from the syntax tree of a file: one small change of its text each."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import TypeGuard

COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", ">"),
    ast.LtE: ("<=", ">="),
    ast.Gt: (">", "<"),
    ast.GtE: (">=", "<="),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
}
FUNCTIONS = {
    **{"max": "min", "min": "max", "maximum": "minimum", "minimum": "maximum"},
    **{"any": "all", "all": "any", "argmax": "argmin", "argmin": "argmax"},
}
TEXTS = (ast.JoinedStr, ast.List, ast.Tuple, ast.Dict)
"""Operands of sums that are no numbers."""
REPORTS = frozenset({"InputError", "Finding", "Quantity", "text", "TypeError", "ValueError"})
"""Calls whose arguments are read by people: tests of texts judge them."""
STARTS = frozenset({"initial", "default"})
"""Keywords of numbers that stand for an empty maximum."""
SHOWN = ("__str__", "__repr__", "facts", "label", "picture", "plot", "summary", "message", "text")
"""Beginnings of the names of functions that only show results."""


@dataclass(frozen=True)
class Edit:
    """A change of the text of a file.

    Attributes:
        line: Number of the line, from 1.
        function: Name of the innermost function or class, empty at the top of the file.
        start, end: Range of bytes that is replaced.
        changed: Its replacement.
        kind: Class of the error, such as ``comparison``.
    """

    line: int
    function: str
    start: int
    end: int
    changed: str
    kind: str

    def apply(self, source: bytes) -> bytes:
        """Return the source with the error."""
        return source[: self.start] + self.changed.encode() + source[self.end :]


def edits(source: bytes) -> list[Edit]:
    """Return all errors of a file, in the order of its text."""
    found = set(_Sites(source).of(ast.parse(source), ""))
    return sorted(found, key=lambda edit: (edit.start, edit.end, edit.changed))


def compiles(source: bytes) -> bool:
    """Return whether a source is Python: a few changes of layout are not."""
    try:
        ast.parse(source)
    except SyntaxError:
        return False
    return True


class _Sites:
    def __init__(self, source: bytes) -> None:
        self._source = source
        lengths = [len(line) for line in source.splitlines(keepends=True)]
        self._starts = [0, *accumulate(lengths)]

    def of(self, node: ast.AST, function: str) -> Iterator[Edit]:
        """Yield the errors of a node and of everything in it."""
        if isinstance(node, ast.Raise | ast.Assert | ast.Import | ast.ImportFrom):
            return
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            function = node.name
            if function.lstrip("_").startswith(SHOWN) or function in SHOWN:
                return
        if isinstance(node, ast.Call) and _name(node.func) in REPORTS:
            return
        if isinstance(node, ast.keyword) and node.arg in STARTS:
            return
        for start, end, changed, kind in self._changes(node, function):
            line = getattr(node, "lineno", 1)
            yield Edit(line, function, start, end, changed, kind)
        if _is_divisor(node):
            node = ast.Tuple(elts=node.args[:2])  # what is divided by nothing has no size
        if _is_mark(node):
            node = ast.Tuple(elts=node.args[:1])
        if not function and _is_series(node):
            return
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "slice", "bases", "defaults"):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from self.of(child, function)

    def _changes(self, node: ast.AST, function: str) -> Iterator[tuple[int, int, str, str]]:
        """Yield range, replacement and kind of the errors of one node."""
        match node:
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                yield from self._between(left, right, *COMPARISONS[type(op)], "comparison")
            case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
                if isinstance(left, TEXTS) or isinstance(right, TEXTS) or _text(left, right):
                    return
                yield from self._between(left, right, *OPERATORS[type(op)], "operator")
                if isinstance(op, ast.Add | ast.Sub):
                    yield *self._range(node), self._text(left), "dropped term"
            case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert(), operand=operand):
                kind = "sign" if isinstance(node.op, ast.USub) else "negation"
                yield *self._range(node), f"({self._text(operand)})", kind
            case ast.BoolOp(op=op, values=values):
                one, other = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
                for a, b in pairwise(values):
                    yield from self._between(a, b, one, other, "logic")
                for dropped in range(len(values)):
                    kept = [self._text(v) for i, v in enumerate(values) if i != dropped]
                    yield *self._range(node), f"({f' {one} '.join(kept)})", "dropped condition"
            case ast.Call(func=func):
                name, (start, end) = _name(func), self._range(func)
                if name in FUNCTIONS:
                    yield end - len(name), end, FUNCTIONS[name], "function"
                elif name == "abs":
                    yield start, end, "", "size"
            case ast.If(
                test=test, body=[ast.Return() | ast.Raise() | ast.Continue() | ast.Break()]
            ):
                yield *self._range(test), "False", "dropped check"
            case ast.Constant(value=float(value)):
                factor = 2.0 if function else 1000.0
                yield *self._range(node), repr(factor * value if value else 1.0), "constant"
            case ast.Assign(value=ast.Constant(value=int(value))) if not function and value > 1:
                yield *self._range(node.value), "1", "constant"

    def _between(
        self, left: ast.expr, right: ast.expr, old: str, new: str, kind: str
    ) -> Iterator[tuple[int, int, str, str]]:
        """Yield the exchange of an operator between two expressions."""
        start, end = self._range(left)[1], self._range(right)[0]
        place = self._source[start:end].find(old.encode())
        if place >= 0:
            yield start + place, start + place + len(old), new, kind

    def _range(self, node: ast.expr) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        start = self._starts[node.lineno - 1] + node.col_offset
        return start, self._starts[node.end_lineno - 1] + node.end_col_offset

    def _text(self, node: ast.expr) -> str:
        start, end = self._range(node)
        return self._source[start:end].decode()


def _is_divisor(node: ast.AST) -> TypeGuard[ast.Call]:
    """Return whether a node is ``np.where(size > 0, size, 1.0)``, whose 1 stands for any number."""
    match node:
        case ast.Call(func=func, args=[_, _, ast.Constant(value=1.0)]):
            return _name(func) == "where"
    return False


def _is_mark(node: ast.AST) -> TypeGuard[ast.Call]:
    """Return whether a node is ``np.full(count, -1.0)``, where -1 marks no value."""
    match node:
        case ast.Call(
            func=func, args=[_, ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=1.0))]
        ):
            return _name(func) == "full"
    return False


def _is_series(node: ast.AST) -> bool:
    """Return whether a node is ``_SHARES = (0.1, 0.2)``, numbers that are tried one by one."""
    match node:
        case (
            ast.Assign(targets=[ast.Name()], value=ast.Tuple(elts=parts))
            | ast.AnnAssign(value=ast.Tuple(elts=parts))
        ):
            return all(isinstance(own, ast.Constant) for own in parts)
    return False


def _text(*operands: ast.expr) -> bool:
    return any(isinstance(own, ast.Constant) and isinstance(own.value, str) for own in operands)


def _name(func: ast.expr) -> str:
    return getattr(func, "attr", "") or getattr(func, "id", "")
