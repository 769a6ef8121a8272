"""The command ``lacore solve``."""

from __future__ import annotations  # not evaluated: what they name is not loaded

from pathlib import Path
from typing import Any

import click

from lacore.errors import InputError
from verification.commands.options import json_option, print_json

_STOPPED = 130


@click.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE.toml")
@click.option(
    "--bracket",
    type=click.FloatRange(min=0, min_open=True),
    metavar="WIDTH",
    help="Prove bounds from both sides until they are this near, per their mean: 0.02.",
)
@click.option(
    "--range",
    "whole_range",
    is_flag=True,
    help="Search for the lowest and the highest load factor, where friction leaves a choice; for"
    " ten minutes at most.",
)
@click.option(
    "--safety",
    is_flag=True,
    help="Prove the factor of safety on strength; with Coulomb friction, between certified states.",
)
@click.option("--interfaces", is_flag=True, help="With --safety, divide friction of contact, too.")
@click.option("--stable", is_flag=True, help="Draw what carries the dead loads, or how they fall.")
@click.option("--sensitivity", is_flag=True, help="List what the load factor depends on.")
@click.option("--cases", is_flag=True, help="Solve each case of the loads alone: which governs?")
@click.option("--envelope", is_flag=True, help="Search all combinations of two or three cases.")
@click.option(
    "--vary",
    metavar="NAME=LOW:HIGH",
    help="A number of the file that varies: 'arch.thickness=5 cm:20 cm'.",
)
@click.option(
    "--critical",
    type=float,
    is_flag=False,
    flag_value=1.0,
    metavar="[TARGET]",
    help="Search along it where the load factor is TARGET; 1 if left out.",
)
@click.option("--limit", is_flag=True, help="Search along it where the dead loads just stand.")
@click.option("--worst", is_flag=True, help="Search along it where the load factor is least.")
@click.option("--backend", metavar="NAME", help="In place of that of the file, or auto.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder for the page, tables, VTU and script; default: reports/FILE.",
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
    """Solve a problem of your own: its load factor, what that is worth, how it falls.

    Cases are names that reference loads have in the file, case = "wind". With --bracket each case,
    and each direction of an envelope, is proven to that width. NAME is what errors call a number
    of the file, or an end of that: bodies.arch.thickness, or thickness, reference_loads[0].at[0].

    FILE.toml states bodies, materials, supports, contact and loads; `lacore new` writes files to
    begin with. Nothing in it is run. Beside the answer come a page with pictures, tables, a file
    for ParaView, and the same problem as Python.

    Exit codes: 0 a load factor is certified, and all else that is asked for, a bracket as narrow;
    1 it is not, or there is none; 2 bad input.

    \b
    Examples:
      lacore new footing > footing.toml
      lacore solve footing.toml
      lacore solve footing.toml --bracket 0.05 --out answer
      lacore solve frame.toml --cases --envelope
      lacore solve arch.toml --vary 'thickness=20 cm:60 cm' --limit
      lacore solve arch.toml --vary 'thickness=20 cm:60 cm' --critical 10
      lacore solve frame.toml --vary 'reference_loads[0].at[0]=0.5:5.5' --worst
    """  # noqa: D301  # click reads the backspace
    folder = out or Path("reports") / file.stem
    try:  # to import all of it takes a second, too
        from lacore.files.problem.reading import read
        from verification import progress
        from verification.problems import answers, records, words, writing

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
        question = answers.asked(stated, backend, bracket=bracket, **more)
        writing.require_writable(folder)
        with stated.locating():
            answer = answers.answered(stated.problem, question, progress.status)
        page, unwritten = None, None
        try:
            page = writing.written(stated, question, answer, folder, progress.status)
        except InputError as error:  # the answer is told all the same
            unwritten = error
    except KeyboardInterrupt:
        click.echo("stopped: there is no answer yet", err=True)
        ctx.exit(_STOPPED)
    if as_json:
        print_json(records.document(stated, answer, page))
    else:
        click.echo(stated.title)
        for name, text in words.lines(answer, stated.units).items():
            click.echo(f"  {name:<12}{text}")
        if page is not None:
            click.echo(f"  {'page':<12}{page}")
    if unwritten is not None:
        raise unwritten
    ctx.exit(0 if answer.good else 1)
