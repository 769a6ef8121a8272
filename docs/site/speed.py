"""Charts of the page of benchmarks, from committed data: who is fast, growth, what width costs."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

import benchmarks
import kept
from myst import Writer
from results import Results
from verification.analysis import costs, performance_profile, shifted_geometric_means
from verification.analysis.profiles import Costs
from verification.case.bracketing import BRACKET
from verification.fuzz.programs.judge import BAR
from verification.report.blocks import Block, Column, Drawing, Heading, Table, Text
from verification.report.charts import axes
from verification.report.charts.axes import Axis
from verification.report.page import results_frame
from verification.verdicts.words import SKIPPED

_SECONDS = Axis("seconds", "processor time [s]")
_UNKNOWNS = Axis("unknowns", "unknowns")
_GROWN = ("assembly", "elastic", "true gap")
"""Benchmarks of the punch, on meshes of several sizes."""
_SHIFT = 0.1  # s: solves that take much less count alike
_ASKED = 0.6  # of all cases: who was asked of as many is compared on what all of them were asked


def page(text: str, results: Results) -> str:
    """The page of the repository with charts before its tables.

    Raises:
        ValueError: the page has no title.
    """
    title, after, rest = text.partition("\n\n")
    if not (title.startswith("# ") and after):
        raise ValueError("the page of benchmarks does not begin with a title")
    blocks = [*_of_benchmarks(kept.load()), *_of_catalogue(results), Heading("All figures")]
    charts = re.sub(r"^### ", "## ", Writer({}).page(blocks), flags=re.MULTILINE)
    return f"{title}\n\n{charts}\n\n{rest}"


def _of_benchmarks(data: Mapping[str, Any]) -> Iterator[Block]:
    frame = benchmarks.records(data)
    runs = [run for runs in frame.loc[frame["kind"] == "programs", "runs"] for run in runs]
    if runs:
        yield from _programs(frame, pd.DataFrame(runs))
    yield Heading("How time grows")
    yield Text(
        "Upper bounds at the same true gap of 1e-5. An elastic solve, of the stiffness of the same"
        " mesh by a direct solver, is the yardstick; assembly is what makes the program of the"
        " problem."
    )
    sizes = frame[frame["kind"].isin(_GROWN)]
    several = sizes.groupby("label")["unknowns"].transform("nunique") > 1
    grown = "Processor time of the smooth punch against its unknowns, on one thread"
    yield Drawing("growth", grown, axes.curves(sizes[several], _UNKNOWNS, _SECONDS, by="label"))
    fits = benchmarks.growth(frame, _GROWN)
    laws = [f"{one.label}: {one.exponent:.2f} ± {one.error:.2f}" for one in fits.itertuples()]
    told = "Exponents of the number of triangles, which unknowns go with"
    yield Text(f"{told}: {'; '.join(laws)}.")
    digest = kept.digest(kept.KEPT.read_bytes())
    yield Text(
        f"The charts above are of `docs/{kept.KEPT.name}`, SHA-256 `{digest}`, measured"
        f" {data['measured']['date']} on one thread of {data['measured']['machine']};"
        " `make bench bench-page` measures them again."
    )


def _programs(frame: pd.DataFrame, runs: pd.DataFrame) -> Iterator[Block]:
    """Random programs, each asked of all exact backends: how many are solved, how fast."""
    (told,) = frame.loc[frame["kind"] == "programs"].to_dict("records")
    right = runs["verdict"] == "right"
    cost = runs.assign(cost=np.where(right, runs["seconds"], np.inf)).pivot(
        index=["family", "place"], columns="backend", values="cost"
    )
    cost = cost.fillna(np.inf)  # who was not asked has solved nothing
    nobody = int((~np.isfinite(cost.to_numpy()).any(axis=1)).sum())
    found = Costs(cost, np.ones(len(cost)), nobody, {"problems": len(cost), "nobody": nobody})
    wrong = runs[runs["verdict"] == "wrong"].groupby("backend").size()
    means = shifted_geometric_means(found, _SHIFT, float(told["limit"]))
    means = means.assign(wrong=means["solver"].map(wrong).fillna(0))
    yield Heading("Which backend is fast: random programs")
    yield Text(
        f"{told['what']}, {runs['unknowns'].min()} to {runs['unknowns'].max()} unknowns, of all"
        " classes of `lacore programs`; `lacore backends` says what each backend is. Solved is"
        f" what residuals within {BAR:g}, computed anew, prove, whatever the solver says. Wrong is"
        " a number that it claims and they refute, which `solve` does not give out, as it judges by"
        " the same residuals; or `locked` or `unsafe` where another backend has a proven number."
        f" Programs that none solved: {nobody}."
    )
    caption = "Share of random programs solved within a factor of the fastest backend"
    yield Drawing("programs", caption, axes.profile(performance_profile(found), axes.FACTOR))
    yield _means(means, wrong=True)


def _of_catalogue(results: Results) -> Iterator[Block]:
    """Whole runs of the catalogue, loops on the friction included."""
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
        yield Heading(f"Which backend is fast: the catalogue, {name}")
        yield Text(
            f"{len(found.cost)} problems that all of these were asked, from the program to the"
            " certificate, with the loop on the friction. Solved is what passes against its"
            " certificate and its reference; regularised backends answer by the rules of"
            " regularised ones. Times are those of the runs of the manual,"
            " beside other work on the machine: factors below two tell little."
        )
        caption = f"Share of {name} solved within a factor of the fastest backend"
        profile = axes.profile(performance_profile(found), axes.FACTOR)
        yield Drawing(f"catalogue-{own}", caption, profile)
        yield _means(means)
    yield Text(f"Of the committed results of the catalogue, SHA-256 `{results.digest}`.")


def _asked_alike(frame: pd.DataFrame) -> pd.DataFrame:
    """Runs of the backends that most cases were asked of, on the problems that all of them were."""
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
        Column("ratio", "of the best", ".2f"),
    ]
    shift, limit = means["shift"].iloc[0], means["limit"].iloc[0]
    some = (means["solved"] < means["problems"]).any()
    counts = f"; what is not solved counts {limit:.3g} s" if some else ""
    caption = f"Geometric means of the time, shifted by {shift:g} s{counts}"
    return Table(tuple(columns), means, caption)
