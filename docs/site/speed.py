"""Charts of the page of benchmarks, from committed data: speed, growth with size, brackets."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

import benchmarks
import kept
from lacore_verification.case.band import BRACKET
from lacore_verification.fuzz.programs.judge import BAR
from lacore_verification.harness.analysis.profiles import (
    Costs,
    costs,
    performance_profile,
    shifted_geometric_means,
)
from lacore_verification.harness.verdicts.words import SKIPPED
from lacore_verification.report.blocks import Block, Drawing, Heading, Table, Text
from lacore_verification.report.charts import axes
from lacore_verification.report.charts.axes import Axis
from lacore_verification.report.columns import Column
from lacore_verification.report.page import results_frame
from myst import Writer
from results import Results

_SECONDS = Axis("seconds", "processor time [s]")
_UNKNOWNS = Axis("unknowns", "unknowns")
_GROWN = ("assembly", "elastic", "true gap")
"""Benchmarks of the punch on meshes of several sizes."""
_SHIFT = 0.1  # s: differences between much shorter times do not count
_ASKED = 0.6  # share of all cases: backends that solved fewer are not compared


def page(text: str, results: Results) -> str:
    """Return the page of the repository with charts before its tables.

    Raises:
        ValueError: The page does not begin with a title.
    """
    title, after, rest = text.partition("\n\n")
    if not (title.startswith("# ") and after):
        raise ValueError("the page of benchmarks does not begin with a title")
    blocks = [*_of_benchmarks(kept.load()), *_of_catalogue(results), Heading("All benchmarks")]
    charts = re.sub(r"^### ", "## ", Writer({}).page(blocks), flags=re.MULTILINE)
    return f"{title}\n\n{charts}\n\n{rest}"


def _of_benchmarks(data: Mapping[str, Any]) -> Iterator[Block]:
    frame = benchmarks.records(data)
    runs = [run for runs in frame.loc[frame["kind"] == "programs", "runs"] for run in runs]
    if runs:
        yield from _programs(frame, pd.DataFrame(runs))
    yield Heading("Growth of time with size")
    yield Text(
        "The chart shows upper bounds at the same true gap of 1e-5. For comparison it also shows an"
        " elastic solve, which solves with the stiffness matrix of the same mesh by a direct"
        " solver, and the assembly of the optimisation program."
    )
    sizes = frame[frame["kind"].isin(_GROWN)]
    several = sizes.groupby("label")["unknowns"].transform("nunique") > 1
    grown = "Processor time of the smooth punch against its unknowns, on one thread"
    yield Drawing("growth", grown, axes.curves(sizes[several], _UNKNOWNS, _SECONDS, by="label"))
    fits = benchmarks.growth(frame, _GROWN)
    laws = [f"{one.label}: {one.exponent:.2f} ± {one.error:.2f}" for one in fits.itertuples()]
    told = "Exponents of the growth with the number of triangles, proportional to the unknowns"
    yield Text(f"{told}: {'; '.join(laws)}.")
    digest = kept.digest(kept.KEPT.read_bytes())
    yield Text(
        f"The charts above show `docs/{kept.KEPT.name}`, SHA-256 `{digest}`, measured"
        f" {data['measured']['date']} on one thread of {data['measured']['machine']};"
        " `make bench bench-page` repeats the measurements."
    )


def _programs(frame: pd.DataFrame, runs: pd.DataFrame) -> Iterator[Block]:
    """Yield how many random programs each exact backend solves, and how fast."""
    (told,) = frame.loc[frame["kind"] == "programs"].to_dict("records")
    right = runs["verdict"] == "right"
    cost = runs.assign(cost=np.where(right, runs["seconds"], np.inf)).pivot(
        index=["family", "place"], columns="backend", values="cost"
    )
    cost = cost.fillna(np.inf)  # a backend without a run has not solved the program
    nobody = int((~np.isfinite(cost.to_numpy()).any(axis=1)).sum())
    found = Costs(cost, np.ones(len(cost)), nobody, {"problems": len(cost), "nobody": nobody})
    wrong = runs[runs["verdict"] == "wrong"].groupby("backend").size()
    means = shifted_geometric_means(found, _SHIFT, float(told["limit"]))
    means = means.assign(wrong=means["solver"].map(wrong).fillna(0))
    yield Heading("Speed of backends: random programs")
    yield Text(
        f"The charts show {told['what']} with {runs['unknowns'].min()} to {runs['unknowns'].max()}"
        " unknowns, of all classes of `lacore programs`. `lacore backends` describes the backends."
        f" A program is solved if the recomputed residuals are at most {BAR:g}, whatever the solver"
        " reports. A result is wrong if these residuals refute it, or if it is `locked` or `unsafe`"
        " and another backend has a proven load factor. `solve` uses the same residuals and does"
        f" not report such results. Number of programs that no backend solved: {nobody}."
    )
    caption = "Share of random programs solved within a factor of the fastest backend"
    yield Drawing("programs", caption, axes.profile(performance_profile(found), axes.FACTOR))
    yield _means(means, wrong=True)


def _of_catalogue(results: Results) -> Iterator[Block]:
    """Yield the speed of whole runs of the catalogue, including the coupling loops."""
    outcomes = [
        own for own in results.outcomes if own.row.coupling != BRACKET and not own.row.ending
    ]
    meshed = [own.run.case.meshed for own in outcomes]
    frame = results_frame(outcomes).assign(meshed=meshed)
    frame = frame[(frame["verdict"] != SKIPPED) & frame["solve_time"].notna()]
    for name, own in (("deformable bodies", True), ("rigid blocks and frames", False)):
        shown = _asked_alike(frame[frame["meshed"] == own])
        found = costs(shown, "solve_time", "verdict", "drop", solver=["backend"])
        means = shifted_geometric_means(found, _SHIFT, float(shown["solve_time"].max()))
        yield Heading(f"Speed of backends: catalogue, {name}")
        yield Text(
            f"The charts show {len(found.cost)} problems that all of these backends were run on,"
            " from the program to the certificate, with the coupling loop. A problem is solved if"
            " its certificate and its reference pass; regularised backends have their own"
            " tolerances. Times are those of the verification manual. Other programs ran at the"
            " same time, so factors below two are not significant."
        )
        caption = f"Share of {name} solved within a factor of the fastest backend"
        profile = axes.profile(performance_profile(found), axes.FACTOR)
        yield Drawing(f"catalogue-{own}", caption, profile)
        yield _means(means)
    yield Text(f"Source: committed results of the catalogue, SHA-256 `{results.digest}`.")


def _asked_alike(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the runs of the backends that ran most cases, on the problems they have in common."""
    problem = ["case", "variant", "mesh"]
    first = frame.drop_duplicates([*problem, "backend"])
    asked = first.groupby("backend")["case"].nunique()
    able = asked.index[asked >= _ASKED * first["case"].nunique()]
    own = first[first["backend"].isin(able)]
    count = own.groupby(problem)["backend"].transform("nunique")
    return own[count == len(able)]


def _means(means: pd.DataFrame, wrong: bool = False) -> Table:
    columns = [
        Column("solver", "backend"),
        Column("solved", form=".0f"),
        *([Column("wrong", form=".0f")] if wrong else []),
        Column("mean", "mean s", ".3g"),
        Column("ratio", "relative to the best", ".2f"),
    ]
    shift, limit = means["shift"].iloc[0], means["limit"].iloc[0]
    some = (means["solved"] < means["problems"]).any()
    counts = f"; unsolved problems count as {limit:.3g} s" if some else ""
    caption = f"Shifted geometric means of the time, with a shift of {shift:g} s{counts}"
    return Table(tuple(columns), means, caption)
