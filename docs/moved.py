"""Rewrite names of modules that have moved: ``python docs/moved.py [FILE]...``, or the whole tree.

Imports, dotted names in strings and pages, and paths of files are rewritten. A second run changes
nothing. Run ``ruff check --fix --select I`` and ``ruff format`` afterwards.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
OWN = Path(__file__).resolve()
STUBS = {
    ROOT / "lacore" / "__init__.pyi": "lacore.",
    ROOT / "verification" / "lacore_verification" / "__init__.pyi": "lacore_verification.",
}
"""Stubs, whose imports are relative, and the packages that they describe."""
KINDS = {".py", ".pyi", ".md", ".toml", ".txt", ".j2", ".in", ".yml", ""}
LEFT_ALONE = ("reports/", "CHANGELOG.md", "docs/moved.py")
PRECEDED = r"(?:(?<![\w./-])|(?<=\.\./))"
"""Before a path of a file, which may be relative."""

FOLDERS = {"backends": "lacore_backends", "verification": "lacore_verification"}
"""Folders of the repository, and the packages that they contain now."""
VERIFICATION = (
    *("load_results", "analysis", "campaigns", "case", "cases", "catalogue", "commands", "report"),
    *("conformance", "defaults", "evidence", "fuzz", "perform", "problems", "progress", "runs"),
    *("store", "usage", "verdicts", "verify", "case_checks"),
)
BACKENDS = tuple(path.stem for path in (ROOT / "backends" / "lacore_backends").glob("[_a-z]*"))
INSIDE = {"backends": BACKENDS, "verification": VERIFICATION}

PROGRAM = (
    *("certificate", "dissipation", "part_forces", "reduction", "regularization", "state"),
    "surfaces",
)
MODEL = ("bodies", "conditions", "contact", "materials", "meshes", "problem")
HARNESS = (
    "analysis",
    "campaigns",
    "evidence",
    "perform",
    "progress",
    "store",
    "verdicts",
    "verify",
)
MOVED = {
    **{f"lacore.{name}": f"lacore.program.{name}" for name in PROGRAM},
    **{f"lacore.{name}": f"lacore.model.{name}" for name in MODEL},
    **{
        f"lacore.{name}": f"lacore.reporting.{name}"
        for name in ("errors", "showing", "status", "views")
    },
    "lacore.arrays": "lacore.numerics.arrays",
    "lacore.backend": "lacore.solvers.backend",
    "lacore.inner": "lacore.solvers.inner",
    "lacore.claims": "lacore.coupling.claims",
    "lacore.adaptive": "lacore.bounds.bracket",
    "lacore.questions": "lacore.analyses",
    "lacore.ranges": "lacore.analyses.ranges",
    "lacore.doors": "lacore.pictures",
    **{f"lacore_verification.{name}": f"lacore_verification.harness.{name}" for name in HARNESS},
    "lacore_verification.fuzz.run": "lacore_verification.harness.perform.random_run",
    "lacore_verification.problems": "lacore_verification.report.problems",
}
"""Modules and packages that have moved, with all that they contain."""
TESTS = {
    **{f"lacore/{name}": f"lacore/model/{name}" for name in MODEL},
    **{
        f"lacore/test_{name}": f"lacore/program/test_{name}"
        for name in ("certificate", "program", "regularization", "surfaces")
    },
    **{f"lacore/test_{name}": f"lacore/reporting/test_{name}" for name in ("errors", "showing")},
    "lacore/inner": "lacore/solvers/inner",
    "lacore/claims": "lacore/coupling/claims",
    "lacore/adaptive": "lacore/bounds/bracket",
    "lacore/questions": "lacore/analyses",
    "lacore/ranges": "lacore/analyses/ranges",
    **{f"verification/{name}": f"verification/harness/{name}" for name in HARNESS},
    "verification/problems": "verification/report/problems",
}
"""Folders and files of tests that have followed them."""


def import_names(text: str) -> str:
    """Return a text with the import names ``lacore_backends`` and ``lacore_verification``."""
    for folder, package in FOLDERS.items():
        inside = "|".join(sorted(INSIDE[folder], key=len, reverse=True))
        text = re.sub(rf"(?<![\w./-]){folder}(?=\.(?:{inside})\b)", package, text)
        text = re.sub(
            rf"(?m)^(\W*(?:from|import) ){folder}(?= import\b| as\b|[\"']?$)", rf"\1{package}", text
        )
        text = re.sub(rf"((?:[\"']-m[\"'],|-m) [\"']?){folder}(?=[\"'`\s])", rf"\1{package}", text)
        path = rf"{PRECEDED}{folder}/(?=(?:{inside}|NAME|_NAME)\b)"
        text = re.sub(path, f"{folder}/{package}/", text)
    return re.sub(r"([\"']-m[\"'], [\"'])lacore_start\b", r"\1lacore_verification", text)


def places(text: str, path: Path) -> str:
    """Return a text with the places of modules inside the packages."""
    new = dict(MOVED)
    names = "|".join(map(re.escape, sorted(new, key=len, reverse=True)))
    text = re.sub(rf"(?<![\w./-])({names})(?![\w/])", lambda found: new[found[1]], text)
    own_names = {old.removeprefix("lacore."): own for old, own in new.items()}
    parts = "|".join((*PROGRAM, "arrays", "backend", "errors", "status"))  # attribute of ``la``
    text = re.sub(
        rf"\bla\.({parts})(?=\.\w)", lambda found: own_names[found[1]].replace("lacore", "la"), text
    )
    for package in ("lacore", "lacore_verification"):
        for name in sorted({old.rpartition(".")[2] for old in new}):
            if (own := new.get(f"{package}.{name}")) is not None:
                above, _, last = own.rpartition(".")
                if last == name:
                    text = re.sub(
                        rf"from {package} import {name}\b(?!,)", f"from {above} import {name}", text
                    )
    if path.suffix == ".py" and path.parts[len(ROOT.parts)] not in ("docs", "examples"):
        inside = "|".join((*PROGRAM, "kinematic"))
        text = re.sub(
            r"\bfrom lacore\.program import\b", "from lacore.program.kinematic import", text
        )
        text = re.sub(
            rf"(?<![\w./-])lacore\.program(?=[.:](?!(?:{inside})\b)\w)",
            "lacore.program.kinematic",
            text,
        )
    for old, own in sorted(new.items(), key=lambda both: -len(both[0])):
        folder = "verification/" if old.startswith("lacore_verification") else ""
        before, after = (folder + name.replace(".", "/") for name in (old, own))
        text = re.sub(rf"{PRECEDED}{before}(?=/|\.py\b)", after, text)
    text = re.sub(rf"{PRECEDED}lacore/program\.py\b", "lacore/program/kinematic.py", text)
    for old, own in TESTS.items():
        end = r"(?=\.py\b)" if "/test_" in old else r"(?![\w-])"
        text = re.sub(rf"{PRECEDED}tests/{old}{end}", f"tests/{own}", text)
        dotted = [name.replace("/", ".") for name in (old, own)]
        text = re.sub(rf"(?<![\w./-])tests\.{dotted[0]}(?!\w)", f"tests.{dotted[1]}", text)
    return text


def stub(text: str, package: str) -> str:
    """Return the stub of a package, whose imports are relative."""
    for old, own in sorted(MOVED.items(), key=lambda both: -len(both[0])):
        if old.startswith(package):
            before, after = old.removeprefix(package), own.removeprefix(package)
            text = re.sub(rf"(?m)^from \.{before}(?=[. ])", f"from .{after}", text)
    return text.replace("from . import meshes", "from .model import meshes")


def rewritten(text: str, path: Path) -> str:
    """Return a text with the names of today."""
    text = places(import_names(text), path)
    return stub(text, STUBS[path]) if path in STUBS else text


def chosen(arguments: list[str]) -> list[Path]:
    """Return the files to rewrite: those that are named, or all that git knows."""
    if arguments:
        return [Path(name).resolve() for name in arguments]
    listed = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files"], capture_output=True, text=True, check=True
    )
    names = [name for name in listed.stdout.splitlines() if not name.startswith(LEFT_ALONE)]
    return [ROOT / name for name in names if Path(name).suffix in KINDS]


def main() -> None:
    """Rewrite the files."""
    for path in chosen(sys.argv[1:]):
        if path == OWN or not path.is_file():
            continue
        text = path.read_text(encoding="utf-8")
        if (new := rewritten(text, path)) != text:
            path.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
