"""Options that several commands share, and how commands print."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

import click

from verification.catalogue.catalogue import Catalogue, find
from verification.catalogue.plugins import gather
from verification.defaults import TIME_LIMIT, cores
from verification.usage import folder, positive, whole

_STOPPED = 130  # as shells say of Ctrl-C
_Command = TypeVar("_Command", bound=Callable[..., Any])


def name_list(ctx: click.Context, option: click.Parameter, value: str | None) -> list[str]:
    """Names between commas: a callback of options."""
    return [name.strip() for name in (value or "").split(",") if name.strip()]


def names_option(name: str, text: str) -> Callable[[_Command], _Command]:
    """An option that takes names between commas."""
    return click.option(name, callback=name_list, metavar="A,B", help=text)


backends_option = names_option(
    "--backends",
    "Comma-separated names of backends (solvers), or 'all'. Default: those that `lacore backends`"
    " marks 'by default' or, for rigid bodies, 'on rigid bodies'.",
)


def drawn_options(things: str, shares: str, default: int) -> Callable[[_Command], _Command]:
    """Gives a command `count` and `seed` of what is drawn at random."""

    def given(command: _Command) -> _Command:
        seed = click.option(
            "--seed", type=whole(0), default=1, show_default=True, metavar="S",
            help=f"Seed of the random generator; each seed gives another set of {things}.",
        )  # fmt: skip
        count = click.option(
            "--count", type=whole(1), default=default, show_default=True, metavar="N",
            help=f"Number of {things}, divided equally among the {shares}.",
        )  # fmt: skip
        return count(seed(command))

    return given


def out_option(default: str, text: str) -> Callable[[_Command], _Command]:
    """Gives a command its folder as the argument `out`."""
    return click.option(
        "--out",
        type=click.Path(path_type=Path),
        default=Path(default),
        show_default=True,
        metavar="DIR",
        callback=folder,
        help=text,
    )


time_limit_option = click.option(
    "--time-limit",
    type=positive,
    default=TIME_LIMIT,
    show_default=True,
    metavar="SECONDS",
    help="Stop any run that takes longer than this.",
)

fresh_option = click.option(
    "--fresh", is_flag=True, help="Repeat runs whose results are already in the folder."
)

json_option = click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON document, and nothing else, on stdout."
)


def _gathered(ctx: click.Context, option: click.Parameter, folders: tuple[Path, ...]) -> Catalogue:
    known = gather(folders)
    for error in known.broken.values():
        click.echo(f"warning: cases omitted: {error}", err=True)
    return known


cases_option = click.option(
    "--cases",
    "known",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="FOLDER",
    callback=_gathered,
    is_eager=True,  # names of cases are looked up in it
    help="Folder with your own cases: each Python file in it defines a variable CASE or CASES. Can"
    " be given several times. Cases of installed packages (entry-point group lacore.cases) are"
    " always included.",
)
"""Gives a command the `Catalogue` as its argument `known`."""


def _existing(
    ctx: click.Context, argument: click.Parameter, names: tuple[str, ...]
) -> tuple[str, ...]:
    for name in names:
        find(name, ctx.params["known"])
    return names


def named_cases(metavar: str, required: bool = False) -> Callable[[_Command], _Command]:
    """Gives a command with the `cases_option` the argument `cases`: names that exist."""
    return click.argument("cases", nargs=-1, required=required, metavar=metavar, callback=_existing)


def jobs_option_with(note: str = "") -> Callable[[_Command], _Command]:
    """Give a command the argument `jobs`; `note` is added to the help text."""
    return click.option(
        "--jobs",
        type=whole(1),
        default=cores,
        metavar="N",
        help="Number of runs at the same time, each in its own process with one thread. Default:"
        f" the number of cores.{note}",
    )


jobs_option = jobs_option_with()


def print_json(document: Any) -> None:
    """One strict document on stdout."""
    click.echo(json.dumps(strict(document), indent=1, allow_nan=False))


def strict(value: Any) -> Any:
    """JSON has no NaN (null here) and no infinity (a string here)."""
    if isinstance(value, dict):
        return {name: strict(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [strict(item) for item in value]
    if isinstance(value, float) and not isfinite(value):
        return None if value != value else str(value)
    return value


@contextmanager
def resumable(store: Path) -> Iterator[None]:
    """On Ctrl-C, explain how to continue, and exit with code 130."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo(
            f"stopped: finished runs are kept in {store}; repeat the command to continue",
            err=True,
        )
        click.get_current_context().exit(_STOPPED)
