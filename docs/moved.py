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
KINDS = {".py", ".pyi", ".md", ".toml", ".txt", ".j2", ".in", ".yml", ""}
LEFT_ALONE = ("reports/", "CHANGELOG.md", "docs/moved.py")
FOLDERS = {"backends": "lacore_backends", "verification": "lacore_verification"}
"""Folders of the repository, and the packages that they contain now."""


def modules(folder: str) -> str:
    """Return a pattern of the modules at the top of a package, as they were and as they are."""
    place = ROOT / folder / FOLDERS[folder]
    names = {path.stem for path in place.iterdir() if path.stem.strip("_") != "pycache"}
    return "|".join(sorted(names - {"__init__"} | EARLIER[folder], key=len, reverse=True))


EARLIER = {
    "backends": set[str](),
    "verification": {
        *("load_results", "analysis", "campaigns", "case", "cases", "catalogue", "commands"),
        *("conformance", "defaults", "evidence", "fuzz", "perform", "problems", "progress"),
        *("report", "runs", "store", "usage", "verdicts", "verify", "case_checks"),
    },
}


def import_names(text: str) -> str:
    """Return a text with the import names ``lacore_backends`` and ``lacore_verification``."""
    for folder, package in FOLDERS.items():
        inside = modules(folder)
        text = re.sub(rf"(?<![\w./-]){folder}(?=\.(?:{inside})\b)", package, text)
        text = re.sub(
            rf"(?m)^(\W*(?:from|import) ){folder}(?= import\b| as\b|[\"']?$)", rf"\1{package}", text
        )
        text = re.sub(rf"((?:[\"']-m[\"'],|-m) [\"']?){folder}(?=[\"'`\s])", rf"\1{package}", text)
        path = rf"(?:(?<![\w./-])|(?<=\.\./)|(?<=\(\.\./)){folder}/(?=(?:{inside}|NAME|_NAME)\b)"
        text = re.sub(path, f"{folder}/{package}/", text)
    return re.sub(r"([\"']-m[\"'], [\"'])lacore_start\b", r"\1lacore_verification", text)


def rewritten(text: str) -> str:
    """Return a text with the names of today."""
    return import_names(text)


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
        if (new := rewritten(text)) != text:
            path.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main()
