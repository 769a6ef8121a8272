"""Write the sources of the site and build it with Sphinx: ``make docs``.

Sources are in reports/site/sources and the site in reports/site/html. Pictures are drawn once.
"""

import argparse
import re
import shutil
import sys
import time
from pathlib import Path

from sphinx.cmd.build import main as sphinx

import api
import gallery
import links
import manual
import pictures
import results
import speed
from lacore_verification.case import Case
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.report import document
from pages import EXTRA, ROOT, Site, sources

FOLDER = ROOT / "reports" / "site"


def build(folder: Path = FOLDER, most: int = sys.maxsize) -> list[str]:
    """Build the site in a folder, and draw at most `most` new pictures.

    Returns:
        Problems of the site: warnings of Sphinx, and broken links.
    """
    for old in ("sources", "html"):  # which may have pages that were removed
        shutil.rmtree(folder / old, ignore_errors=True)
    site = Site(folder / "sources", sources())
    site.copy()
    site.put(f"{EXTRA}/_static/charts.css", _charts_css())
    site.put(f"{EXTRA}/llms.txt", (ROOT / "lacore" / "llms.txt").read_bytes())
    for page, text in {**api.pages(), **_of_cases(site, [*catalogue().values()], most)}.items():
        site.write(page, text)
    here = str(Path(__file__).parent)
    places = [str(folder / name) for name in ("doctrees", "sources", "html")]
    copied = f"html_extra_path={folder / 'sources' / EXTRA}"
    anew = ["-E"]  # the navigation of every page shows the titles of all others
    failed = sphinx(["-q", *anew, "-W", "--keep-going", "-c", here, "-D", copied, "-d", *places])
    return [*(["Sphinx warned"] if failed else []), *links.broken(folder / "html")]


def _charts_css() -> bytes:
    """Return the colours of charts, as reports define them, for the light and the dark scheme."""
    style = (Path(document.__file__).parent / "style.html.j2").read_text(encoding="utf-8")
    light, dark = (own.replace("\n", " ") for own in re.findall(r":root \{([^}]*)\}", style)[:2])
    light = light.partition(";")[2]  # the scheme is chosen by the theme
    auto = "@media (prefers-color-scheme: dark) { body:not([data-theme=light])"
    return (f"body {{{light}}}\nbody[data-theme=dark] {{{dark}}}\n{auto} {{{dark}}} }}\n").encode()


def _of_cases(site: Site, cases: list[Case], most: int) -> dict[str, str]:
    kept, found = pictures.Kept(site.folder.parent / "drawn"), results.load()
    benchmarks = (site.folder / "benchmarks.md").read_text(encoding="utf-8")
    shown = kept.drawn(cases, found.outcomes, most)
    for file, data in {**pictures.files(shown), **gallery.thumbnails(cases, shown)}.items():
        site.put(file, data)
    return {
        **{f"manual/{case.id}.md": manual.page(case, found, shown) for case in cases},
        manual.INDEX: manual.index(cases, found),
        "manual/excluded.md": manual.excluded(cases, found),
        "gallery.md": gallery.page(cases, shown),
        "benchmarks.md": speed.page(benchmarks, found),
    }


def main() -> int:
    """Build the site, print its problems, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=FOLDER)
    parser.add_argument(
        "--most", type=int, default=sys.maxsize, help="largest number of new pictures"
    )
    asked = parser.parse_args()
    begin = time.perf_counter()
    wrong = build(asked.folder.resolve(), asked.most)
    spent = time.perf_counter() - begin
    print(*wrong, f"{asked.folder / 'html' / 'index.html'}: {spent:.0f} s", sep="\n")  # noqa: T201
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
