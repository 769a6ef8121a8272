"""Errors to inject: known ones from a list, and those generated from the syntax tree."""

import hashlib
import random
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from tests.mutants.sites import Edit, compiles, edits

KNOWN = Path(__file__).with_name("known.toml")
_NAMES = (
    *(
        "program/certificate.py",
        "program/free_motion.py",
        "program/power.py",
        "coupling",
        "bounds",
        "model/contact",
        "model/materials",
        "assembly",
    ),
    "analyses/ranges",
)
PACKAGES = tuple(Path("lacore", name) for name in _NAMES)
"""Sources of the generated errors: in these packages an error proves something wrong."""


class StaleError(Exception):
    """An entry of the list no longer fits the sources."""


@dataclass(frozen=True)
class Mutant:
    """One error.

    Attributes:
        path: File, relative to the root of the tree.
        place: Line and function.
        kind: Class of the error, or its description in the list.
        change: Original and changed text.
        source: File with the error.
        tests: Paths of the tests that should notice.
        equivalent: Reason why no test can notice; empty otherwise.
    """

    path: Path
    place: str
    kind: str
    change: str
    source: bytes
    tests: tuple[str, ...]
    equivalent: str = ""

    @property
    def key(self) -> str:
        """Digest of the file with the error."""
        return hashlib.sha256(str(self.path).encode() + b"\0" + self.source).hexdigest()[:16]

    def __str__(self) -> str:
        return f"{self.path}:{self.place}: {self.kind}: {self.change}"


def known(root: Path) -> list[Mutant]:
    """Return the errors of the list.

    Raises:
        StaleError: an original text is not exactly once in the files that match.
    """
    entries = tomllib.loads(KNOWN.read_text(encoding="utf-8"))["mutant"]
    return [_known(root, **entry) for entry in entries]


def _known(
    root: Path,
    file: str,
    original: str,
    changed: str,
    why: str,
    tests: Sequence[str] = (),
    equivalent: str = "",
) -> Mutant:
    places = [path for path in _sources(root) if path.as_posix().endswith(f"/{file}")]
    found = [path for path in places if (root / path).read_text("utf-8").count(original) == 1]
    if len(found) != 1:
        raise StaleError(
            f"known.toml, file = {file!r}: {len(found)} of {len(places)} files of this name contain"
            f" the text {original!r} exactly once; write the new text of the code"
        )
    (path,) = found
    text = (root / path).read_text(encoding="utf-8")
    start = text.index(original)
    source = (text[:start] + changed + text[start + len(original) :]).encode()
    line = str(text.count("\n", 0, start) + 1)
    change = f"{_short(original)} -> {_short(changed)}"
    run = tuple(tests) or tests_of(root, path)
    return Mutant(path, line, why, change, source, run, equivalent)


def generated(root: Path, sample: int, seed: int, only: str = "") -> list[Mutant]:
    """Return a random sample of the errors in `PACKAGES`.

    Args:
        root: Of the tree.
        sample: Number of errors, or fewer where there are not as many.
        seed: Of the random choice.
        only: Part of the path of the file; empty: all files.
    """
    sources = {
        path: (root / path).read_bytes()
        for path in _sources(root)
        if any(path == own or own in path.parents for own in PACKAGES) and only in str(path)
    }
    candidates = [(path, edit) for path, source in sources.items() for edit in edits(source)]
    random.Random(seed).shuffle(candidates)
    possible = (own for own in candidates if compiles(own[1].apply(sources[own[0]])))
    return [_generated(root, *own, sources[own[0]]) for own in islice(possible, sample)]


def _generated(root: Path, path: Path, edit: Edit, source: bytes) -> Mutant:
    original = source[edit.start : edit.end].decode()
    changed = edit.changed or "nothing"
    return Mutant(
        path,
        f"{edit.line} {edit.function}".strip(),
        edit.kind,
        f"{_context(source, edit.start, edit.end)}: {_short(original)} -> {_short(changed)}",
        edit.apply(source),
        tests_of(root, path),
    )


def tests_of(root: Path, path: Path) -> tuple[str, ...]:
    """Return the tests of the package of a file: of the innermost one that has tests of its own."""
    own = sorted(root.joinpath("tests", "lacore", "program").glob(f"test_{path.stem}*.py"))
    if path.parts[:2] == ("lacore", "program") and own:
        return tuple(file.relative_to(root).as_posix() for file in own)
    parts = [part for part in path.parts if not part.startswith("lacore_")]
    for depth in range(len(parts) - 1, 0, -1):
        folder = root.joinpath("tests", *parts[:depth])
        if folder.is_dir():
            return (folder.relative_to(root).as_posix(),)
    raise StaleError(f"{path}: no package around it has tests")


def _sources(root: Path) -> list[Path]:
    tops = [path for path in sorted(root.iterdir()) if path.name not in _ASIDE]
    files = [file for top in tops if top.is_dir() for file in sorted(top.rglob("*.py"))]
    return [file.relative_to(root) for file in files]


_ASIDE = frozenset({"tests", "docs", "examples", "reports", "build", "dist", ".venv", ".git"})


def _context(source: bytes, start: int, end: int) -> str:
    """Return the lines of a range, without spaces around them."""
    first = source.rfind(b"\n", 0, start) + 1
    last = source.find(b"\n", end)
    return _short(source[first:last].decode(), 100)


def _short(text: str, most: int = 60) -> str:
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 4]} ..."
