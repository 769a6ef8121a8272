"""The command ``lacore new``: starter files."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

import click

from lacore.reporting.errors import require_known
from lacore_verification.commands.options import json_option, print_json


@click.command(short_help="Print a starter file, or list all starter files.")
@click.argument("name", required=False)
@click.option("--schema", is_flag=True, help="Print the JSON schema of problem files.")
@json_option
def new(name: str | None, schema: bool, as_json: bool) -> None:
    """Print a starter file that describes a problem; without NAME, list all starter files.

    Each file describes a complete problem that `lacore solve` solves within seconds. Its comments
    explain what to change. Editors that support JSON schemas complete keys and mark mistakes in
    problem files when they are given the schema.

    \b
    Examples:
      lacore new
      lacore new footing > footing.toml
      lacore new --schema > problem.schema.json
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.report.problems import starters

    titles = starters.titles()
    if name is not None:
        require_known("NAME", name, titles)
    if schema:
        click.echo(starters.schema(), nl=False)
    elif name is None and as_json:
        print_json(titles)
    elif name is None:
        for own, title in titles.items():
            click.echo(f"{own:<18}{title}")
        click.echo("\nNext: lacore new NAME > my.toml, edit the file, then lacore solve my.toml")
    elif as_json:
        print_json({"name": name, "title": titles[name], "text": starters.text(name)})
    else:
        click.echo(starters.text(name), nl=False)
