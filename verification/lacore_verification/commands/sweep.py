"""The command ``lacore sweep``."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lacore.coupling.kinds import COUPLINGS
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.commands.options import (
    backends_option,
    cases_option,
    jobs_option,
    json_option,
    named_cases,
    names_option,
    out_option,
    print_json,
    repeat_options,
    resumable,
    show_stored_failures,
    time_limit_option,
)
from lacore_verification.defaults import RAW
from lacore_verification.harness.perform.executors import (
    dask_options,
    executor_of,
    require_one_place,
)
from lacore_verification.harness.verdicts.words import FAIL

if TYPE_CHECKING:
    import pandas as pd

    from lacore_verification.harness.campaigns.run_all import Repeat
    from lacore_verification.runs.outcome import Outcome

PENALTIES = ("r", "eta", "bulk", "normal", "tangential")
"""Options whose errors have a theory (T19)."""


@click.command(short_help="Run cases over grids of parameters.")
@named_cases("CASE...", required=True)
@click.option(
    "--vary",
    multiple=True,
    metavar="NAME=VALUES",
    help="Parameter and its values: START:STOP:N for equal distances, START:STOP:N:log for equal"
    " ratios, or a list a,b,c. Several --vary options form a grid.",
)
@backends_option
@names_option(
    "--meshes",
    "Comma-separated mesh levels. Default: the levels of each variant, or the first level if a mesh"
    " size is varied.",
)
@names_option(
    "--couplings",
    f"Comma-separated iteration methods for Coulomb friction: {', '.join((*COUPLINGS, *RAW))}."
    " Default: the method of each backend.",
)
@jobs_option
@dask_options
@time_limit_option
@out_option("reports/sweep", "Folder for the results.")
@repeat_options
@cases_option
@json_option
@click.pass_context
def sweep(
    ctx: click.Context,
    cases: tuple[str, ...],
    vary: tuple[str, ...],
    backends: list[str],
    meshes: list[str],
    couplings: list[str],
    jobs: int,
    on_dask: bool,
    scheduler: str | None,
    time_limit: float,
    out: Path,
    repeat: Repeat,
    known: Catalogue,
    as_json: bool,
) -> None:
    """Run cases over grids of parameters, mesh sizes, loop settings and backend options.

    CASE is the name of a case (see `lacore cases`), or NAME:VARIANT for one variant of it. The NAME
    in --vary is one of the following:

    \b
      parameter of the case     mu; steps and scheme of a loading path
      size of the mesh          n, nx
      setting of the loop       damping, anderson, start, tolerance, max_iterations
      option of the backend     r, eta, bulk, normal, tangential (or K_c, K_n, K_t)

    Write param.NAME, size.NAME, setting.NAME or option.NAME if a name has several meanings.

    An option is passed only to backends that have it. A backend without the option runs once, for
    comparison with all values. A value that a case or a backend rejects gives a row with the
    reason, and does not stop the sweep.

    Each result is stored in DIR as soon as it is computed. A sweep that was stopped continues when
    the same command is repeated. In Python, `lacore_verification.load_results(DIR)` returns the
    table of all results in DIR, which is also written to results.csv.

    Exit code: 0 if all runs finished and none is wrong or failed, 1 otherwise, 2 for invalid input,
    130 after Ctrl-C.

    \b
    Examples:
      lacore sweep prandtl-punch:smooth --vary r=1e-1:1e-5:9:log --backends newton,clarabel
      lacore sweep deformable-block:sliding --vary mu=0.1:0.9:17 --meshes coarse --jobs 4
      lacore sweep hardening-cylinder:voce --vary steps=5:40:4:log --vary scheme=leapfrog,explicit
      lacore sweep wall-1 --vary damping=0.3,0.7,1 --vary anderson=0,5 --couplings reaction
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.commands import screen, tables
    from lacore_verification.harness import progress
    from lacore_verification.harness.campaigns.run_all import run_all
    from lacore_verification.harness.campaigns.sweep import plan
    from lacore_verification.harness.store.results import export, load_results
    from lacore_verification.harness.store.store import NAME

    runs = plan(cases, vary, backends, meshes, couplings, known)
    require_one_place(on_dask, scheduler)
    with (
        resumable(out / NAME),
        executor_of(jobs, on_dask, scheduler, _folders(known)) as executor,
        progress.watching(len(runs)) as watch,
    ):
        outcomes = run_all(
            runs,
            out / NAME,
            watch.start,
            watch.finish,
            executor,
            time_limit,
            repeat,
            show_stored_failures,
        )
    export(load_results(out), out / "results.csv")
    slopes, orders = _slopes(out, outcomes), _orders(out, outcomes)
    if as_json:
        print_json(_document(out, outcomes, slopes, orders))
    else:
        console = screen.table_console()
        tables.show_sweep(console, outcomes)
        if slopes:
            tables.show_slopes(console, slopes)
        if orders:
            tables.show_step_orders(console, orders)
        click.echo(f"\nResults: {out / NAME}\nTable:   {out / 'results.csv'}")
    ctx.exit(1 if any(outcome.row.verdict == FAIL for outcome in outcomes) else 0)


def _folders(known: Catalogue) -> list[Path]:
    """Return the folders of users' cases."""
    paths = [Path(source) for source in known.sources.values()]
    return sorted({path.parent for path in paths if path.is_file()})


def _document(
    out: Path,
    outcomes: Sequence[Outcome],
    slopes: Sequence[dict[str, Any]],
    orders: Sequence[dict[str, Any]],
) -> dict[str, Any]:
    from lacore_verification.harness.store.provenance import describe
    from lacore_verification.harness.store.store import NAME

    statuses = Counter(outcome.row.status for outcome in outcomes)
    verdicts = Counter(outcome.row.verdict for outcome in outcomes)
    return {
        "summary": {"runs": len(outcomes), "statuses": dict(statuses), "verdicts": dict(verdicts)},
        "slopes": list(slopes),
        "step_orders": list(orders),
        "store": str(out / NAME),
        "machine": describe(outcome.run.backend for outcome in outcomes),
        "rows": [outcome.record() for outcome in outcomes],
    }


def _slopes(out: Path, outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Return the slopes of the errors of T19 against each penalty that was varied."""
    varied = [
        f"option_{name}"
        for name in PENALTIES
        if len({run.options[name] for run in (o.run for o in outcomes) if name in run.options}) > 1
    ]
    if not varied:
        return []
    import pandas as pd

    # imported here, because it takes most of a second that other sweeps do not need
    from lacore_verification.harness.analysis.exact import with_exact
    from lacore_verification.harness.analysis.slope_fits import regularisation_slopes

    joined = with_exact(_results(out, outcomes))
    found = pd.concat([regularisation_slopes(joined, name) for name in varied])
    return found.to_dict("records")  # type: ignore[return-value]  # columns are text


def _orders(out: Path, outcomes: Sequence[Outcome]) -> list[dict[str, Any]]:
    """Return the orders of the errors of paths in their steps, if these were varied."""
    if len({o.run.parameters["steps"] for o in outcomes if o.run.case.path is not None}) < 2:
        return []
    # imported here, because it takes most of a second that other sweeps do not need
    from lacore_verification.harness.analysis.stepping import step_orders

    return step_orders(_results(out, outcomes)).to_dict("records")  # type: ignore[return-value]


def _results(out: Path, outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return all results in the folder of a sweep."""
    from lacore_verification.harness.store.results import load_results

    keys = {outcome.run.key for outcome in outcomes}
    results = load_results(out)
    return results[results["run"].isin(keys)]
