"""Pages of the repository as sources of the site, with links adapted.

Pages link to files of the repository, so that they can be read there as well. On the site, links
lead to the pages of the site, and files of code are copied.
"""

import posixpath
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXTRA = "extra"
"""Folder of files that are copied to the site unchanged."""
_LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[^)\s]*)?\)")
_PLACES = {
    "README.md": "index.md",
    "verification/lacore_verification/cases": "manual/index.md",
    "docs/guide": "index.md",
}
"""Pages of the site that stand for other files and folders of the repository."""
_ENTRANCES = {"docs/guide/start-structure.md": (), "docs/guide/start-solver.md": ("../backends",)}
"""Pages that lead to all pages of the guide, and to others that the navigation shows with them."""
_KEPT = {"reports/reference": "reference"}
"""Folders that are copied whole, because they contain pages."""
_RECORDS = {"CHANGELOG.md", "docs/design-decisions.md"}
"""Files with numbers that were measured once. Numbers on the site are computed or stored data."""


def sources() -> dict[str, str]:
    """Return the pages of the site by their files in the repository."""
    found = {"CONTRIBUTING.md": "contributing.md"}
    for path in sorted((ROOT / "docs").rglob("*.md")):
        own = path.relative_to(ROOT / "docs")
        found[f"docs/{own.as_posix()}"] = own.as_posix().removeprefix("site/")
    return {file: page for file, page in found.items() if file not in _RECORDS}


def contents() -> dict[str, str]:
    """Return the hidden table of contents of each entrance: the pages that it links to first.

    Raises:
        ValueError: No entrance leads to a page of the guide.
    """
    left = {path.name for path in (ROOT / "docs" / "guide").glob("*.md")}
    left -= {posixpath.basename(entrance) for entrance in _ENTRANCES}
    found = {}
    for entrance, others in _ENTRANCES.items():
        text = (ROOT / entrance).read_text(encoding="utf-8")
        names = [n for n in dict.fromkeys(re.findall(r"\]\(([\w-]+\.md)", text)) if n in left]
        own = [name.removesuffix(".md") for name in names]
        found[entrance] = "\n".join(["", ":::{toctree}", ":hidden:", *own, *others, ":::", ""])
        left -= set(names)
    if left:
        raise ValueError(f"{' and '.join(_ENTRANCES)} do not link to {', '.join(sorted(left))}")
    return found


@dataclass(frozen=True)
class Site:
    """The sources of the site.

    Attributes:
        folder: Folder of the sources that Sphinx reads.
        pages: Pages of the site by file of the repository.
    """

    folder: Path
    pages: Mapping[str, str]

    def copy(self) -> None:
        """Copy all pages of the repository, and the files that they show."""
        more = contents()
        for source, page in self.pages.items():
            text = (ROOT / source).read_text(encoding="utf-8")
            self.write(page, self._led(text, source, page) + more.get(source, ""))
        for source, folder in _KEPT.items():
            shutil.copytree(ROOT / source, self.folder / EXTRA / folder, dirs_exist_ok=True)

    def write(self, page: str, text: str) -> None:
        """Write a page."""
        self.put(page, text.encode())

    def put(self, file: str, data: bytes) -> None:
        """Write a file."""
        path = self.folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)

    def _led(self, text: str, source: str, page: str) -> str:
        def link(found: re.Match[str]) -> str:
            picture, words, file, anchor = (part or "" for part in found.groups())
            if not file or ":" in file:
                return found[0]
            target = posixpath.normpath(posixpath.join(posixpath.dirname(source), file))
            if not (ROOT / target).exists():
                raise FileNotFoundError(f"{source} links to {target}, which does not exist")
            if picture or target.endswith(".svg"):
                return f"{picture}[{words}]({self._beside(page, self._picture(target))})"
            if target in _RECORDS:
                return f"{words} (`{target}` of the repository)"
            own = self.pages.get(target, _PLACES.get(target, ""))
            if own:
                return f"[{words}]({self._beside(page, own)}{anchor})"
            return f'<a href="{self._beside(page, self._copied(target))}">{words}</a>'

        return _LINK.sub(link, text)

    @staticmethod
    def _beside(page: str, target: str) -> str:
        return posixpath.relpath(target, posixpath.dirname(page) or ".")

    def _picture(self, target: str) -> str:
        own = target.removeprefix("docs/")
        self._copy(target, own)
        return own

    def _copied(self, target: str) -> str:
        """Copy a file, or the README of a folder, and return its path on the site."""
        if target in _KEPT:
            return f"{_KEPT[target]}/index.html"
        if (ROOT / target).is_dir():
            target = f"{target}/README.md"
        own = f"files/{target}"
        self._copy(target, f"{EXTRA}/{own}")
        return own

    def _copy(self, target: str, own: str) -> None:
        path = self.folder / own
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / target, path)
