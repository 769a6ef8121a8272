"""The command ``lacore solve``."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lacore.reporting.errors import InputError
from lacore_verification.commands.options import json_option, print_json
from lacore_verification.defaults import STOPPED
from lacore_verification.usage import Sectioned, folder, number, positive

if TYPE_CHECKING:
    from lacore.files.problem.reading import Stated

_NAME = 17  # characters
_SECTIONS = {
    "Bounds and safety": ("bracket", "whole_range", "safety", "interfaces", "stable"),
    "Influence of parameters": ("sensitivity", "vary", "critical", "limit", "worst"),
    "Load cases": ("cases", "envelope"),
}


@click.command(
    cls=Sectioned, sections=_SECTIONS, short_help="Compute the collapse load of a problem file."
)
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.toml")
@click.option(
    "--bracket",
    type=positive,
    metavar="WIDTH",
    help="Compute a lower and an upper bound on the load factor, and refine the mesh until they"
    " differ by at most the fraction WIDTH of their mean; 0.02 means 2 %.",
)
@click.option(
    "--range",
    "whole_range",
    is_flag=True,
    help="Search for the lowest and the highest load factor. With friction, more than one load"
    " factor may be possible. The search takes up to ten minutes.",
)
@click.option(
    "--safety",
    is_flag=True,
    help="Compute the factor of safety: the structure collapses under the loads in the file"
    " (load factor 1) if the strength of all materials is divided by it.",
)
@click.option(
    "--interfaces",
    is_flag=True,
    help="With --safety, also divide the friction coefficients between bodies.",
)
@click.option(
    "--stable",
    is_flag=True,
    help="Prove whether the dead loads alone are carried, and draw the stresses that carry them or"
    " the mechanism by which the structure collapses.",
)
@click.option(
    "--sensitivity",
    is_flag=True,
    help="List by how much the load factor changes with each parameter.",
)
@click.option(
    "--cases",
    is_flag=True,
    help="Compute the load factor of each load case separately, and name the governing case. In the"
    " file, assign reference loads to cases, such as case = 'wind'.",
)
@click.option(
    "--envelope",
    is_flag=True,
    help="Compute which combinations of two or three load cases the structure carries.",
)
@click.option(
    "--vary",
    metavar="NAME=LOW:HIGH",
    help="Vary a number in the file between two values, such as 'arch.thickness=5 cm:20 cm'. Needs"
    " --critical, --limit or --worst.",
)
@click.option(
    "--critical",
    type=number,
    is_flag=False,
    flag_value=1.0,
    metavar="[TARGET]",
    help="Find the value of the varied number for which the load factor is TARGET, by default 1.",
)
@click.option(
    "--limit",
    is_flag=True,
    help="Find the value of the varied number for which the dead loads alone are just carried.",
)
@click.option(
    "--worst",
    is_flag=True,
    help="Find the value of the varied number for which the load factor is lowest.",
)
@click.option(
    "--backend",
    metavar="NAME",
    help="Solver to use; `lacore backends` lists the solvers. Default: the solver named in the"
    " file, or else auto, which selects one.",
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="DIR",
    callback=folder,
    help="Folder for the report. Default: reports/NAME for the file NAME.toml.",
)
@json_option
@click.pass_context
def solve(
    ctx: click.Context,
    file: Path,
    bracket: float | None,
    whole_range: bool,
    safety: bool,
    interfaces: bool,
    stable: bool,
    sensitivity: bool,
    cases: bool,
    envelope: bool,
    vary: str | None,
    critical: float | None,
    limit: bool,
    worst: bool,
    backend: str | None,
    out: Path | None,
    as_json: bool,
) -> None:
    """Compute the load factor at which the structure described in FILE.toml collapses.

    The file describes bodies, materials, supports, contact and loads. `lacore new` prints starter
    files. The load factor is the number by which the reference loads of the file are multiplied at
    collapse; the dead loads remain constant.

    The load factor is printed with the collapse mechanism and with a statement of what is proven.
    The report folder (see --out) then contains a report with pictures (index.html), tables, the
    velocities and stresses for ParaView (state.vtu), and the same problem as a Python script
    (problem.py).

    In --vary NAME=LOW:HIGH, NAME is the path of a number in the file, such as bodies.arch.thickness
    or reference_loads[0].at[0]. The end of the path, such as arch.thickness or thickness, is
    enough if it is unique.

    If the file has a table [path], the bodies are followed through large deformation. The history
    is printed, and the report folder contains it as CSV, with a series of files for ParaView
    (shapes/path.pvd).

    Exit code: 0 if the load factor and all results of the given options are certified, 1 if one of
    them is missing or not certified, 2 for invalid input. A result is certified if it passes the
    checks of equilibrium, strength and friction. With --bracket, the bounds must also be close
    enough to each other.

    \b
    Examples:
      lacore new footing > footing.toml
      lacore solve footing.toml
      lacore solve footing.toml --bracket 0.05 --out footing-report
      lacore solve frame.toml --cases --envelope
      lacore solve arch.toml --vary 'thickness=20 cm:60 cm' --limit
      lacore solve arch.toml --vary 'thickness=20 cm:60 cm' --critical 10
      lacore solve frame.toml --vary 'reference_loads[0].at[0]=0.5:5.5' --worst
    """  # noqa: D301  # click reads the backspace
    place = out or Path("reports") / file.stem
    try:  # includes the imports, which take a second
        from lacore.files.problem.reading import read
        from lacore_verification.harness import progress
        from lacore_verification.report.problems import answers, records, words, writing

        stated = read(file)
        more: dict[str, Any] = {
            "stable": stable,
            "sensitivity": sensitivity,
            "cases": cases,
            "envelope": envelope,
        }
        more |= {"range": whole_range, "safety": safety, "interfaces": interfaces}
        more |= {"vary": vary, "limit": limit, "worst": worst}
        more |= {} if critical is None else {"critical": critical}
        if stated.path is not None:
            ctx.exit(_followed(stated, backend, place, as_json, {"bracket": bracket, **more}))
        question = answers.asked(stated, backend, bracket=bracket, **more)
        writing.require_writable(place)
        with stated.locating():
            answer = answers.answered(stated.problem, question, progress.status)
        page, unwritten = None, None
        try:
            page = writing.written(stated, question, answer, place, progress.status)
        except InputError as error:  # reported after the result, which is complete
            unwritten = error
    except KeyboardInterrupt:
        click.echo("stopped before the load factor was computed", err=True)
        ctx.exit(STOPPED)
    if as_json:
        print_json(records.document(stated, answer, page))
    else:
        click.echo(stated.title)
        for name, text in words.lines(answer, stated.units).items():
            click.echo(f"  {name:<{_NAME}}{text}")
        if page is not None:
            click.echo(f"  {'report':<{_NAME}}{page}")
    if answer.refused is not None:
        with stated.locating():
            raise answer.refused
    if unwritten is not None:
        raise unwritten
    ctx.exit(0 if answer.good else 1)


def _followed(
    stated: Stated, backend: str | None, place: Path, as_json: bool, more: dict[str, Any]
) -> int:
    """Follow the path of a file, print it, and return the exit code."""
    from lacore_verification.harness import progress
    from lacore_verification.report.problems import following, path_page, writing

    backend = following.path_backend(stated, backend, more)
    writing.require_writable(place)
    page, unwritten, steps = None, None, following.Steps(place)
    try:
        found = following.followed(stated, backend, steps, progress.status)
    except KeyboardInterrupt:
        click.echo(f"stopped after {steps.told}", err=True)
        return STOPPED
    try:
        page = path_page.written(stated, found, place, progress.status)
    except InputError as error:  # reported after the result, which is complete
        unwritten = error
    if as_json:
        print_json(path_page.document(stated, found, page))
    else:
        click.echo(stated.title)
        for name, text in path_page.lines(stated, found).items():
            click.echo(f"  {name:<{_NAME}}{text}")
        if page is not None:
            click.echo(f"  {'report':<{_NAME}}{page}")
        click.echo(path_page.history_text(stated, found.path))
    if unwritten is not None:
        raise unwritten
    return 0 if found.good else 1
