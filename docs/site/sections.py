"""The sections of docs/benchmarks.md, and the columns of their tables."""

from collections.abc import Mapping
from dataclasses import dataclass

SOLVES = ("assembly", "elastic", "solve")
"""Benchmarks of backends with their defaults, and of assembly and elastic solves."""
Columns = Mapping[str, tuple[str, str]]
"""Columns of a table: field of a record, and its format; two digits if the format is empty."""


@dataclass(frozen=True)
class Section:
    """A section: a table of benchmarks with its explanation.

    Attributes:
        kinds: Kinds of records in the table; a record with a list of runs gives one row per run.
        heading: Heading; if empty, the section continues the one before.
        text: Explanation of the table.
        columns: Columns of the table.
        order: Columns by which rows are sorted.
    """

    kinds: tuple[str, ...]
    heading: str
    text: str
    columns: Columns
    order: tuple[str, ...] = ()


SECTIONS = (
    Section(
        ("held",),
        "Requirements",
        "These limits were set before they were reached. An aim is a stricter value that is not"
        " required. Elapsed times are of two bounds computed in parallel on two cores; all other"
        " times are processor times on one thread, and ratios are of times in the same run.",
        {
            "benchmark": ("what", "{}"),
            "required": ("bar", "{}"),
            "aim": ("aim", "{}"),
            "measured": ("measured", "{}"),
            "fulfilled": ("holds", "{}"),
        },
    ),
    Section(
        ("bracket",),
        "Time of brackets",
        "**Brackets**, from the first mesh to the certificate, including all solves and"
        " refinements. Seconds are the processor time if one bound is computed after the other."
        " Elastic solves give the same time in units of one elastic solve on the last mesh of the"
        " upper bound. The last columns are of both bounds in parallel, which gives the same"
        " bounds.",
        {
            "bracket": ("what", "{}"),
            "lower": ("lower", "{:.5f}"),
            "upper": ("upper", "{:.5f}"),
            "width": ("width", "{:.3%}"),
            "triangles of the lower bound": ("triangles_lower", "{:.0f}"),
            "of the upper bound": ("triangles_upper", "{:.0f}"),
            "solves": ("solves", "{:.0f}"),
            "seconds": ("seconds", ""),
            "elastic solves": ("elastic_solves", "{:.0f}"),
            "in parallel, elapsed s": ("wall", ""),
            "in parallel, processor s": ("of_both", ""),
        },
        ("problem", "-width"),
    ),
    Section(
        ("bracket peers",),
        "",
        "**The same brackets by each backend**, one bound after the other, in one run. `cvxpy`"
        " calls Clarabel through cvxpy, without the scaling of rows that lacore uses. At the same"
        " nominal tolerance its gaps are larger, so it needs more elements or reaches the largest"
        " number that is allowed.",
        {
            "bracket": ("what", "{}"),
            "backend": ("backend", "{}"),
            "width": ("width", "{:.3%}"),
            "ending": ("ending", "{}"),
            "solves": ("solves", "{:.0f}"),
            "seconds": ("seconds", ""),
            "relative to auto": ("ratio", ""),
        },
    ),
    Section(
        ("true gap",),
        "Time of one solve",
        "**Upper bounds of the smooth punch at the same true gap**, at most 1e-5. The true gap is"
        " the recomputed difference between the dissipation of the velocity and the load of the"
        " stresses. Each tolerance is the loosest of three that reaches this gap. The uncertainty"
        " is the largest error of the load that the residuals permit. Memory is the peak of the"
        " process.",
        {
            "backend": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "unknowns": ("unknowns", "{:.0f}"),
            "tolerance": ("tolerance", "{:.0e}"),
            "true gap": ("gap", "{:.0e}"),
            "uncertainty": ("doubt", "{:.0e}"),
            "seconds": ("seconds", ""),
            "elastic solves": ("elastic_solves", ""),
            "iterations": ("iterations", "{:.0f}"),
            "memory, MB": ("memory_mb", "{:.0f}"),
        },
        ("triangles", "seconds"),
    ),
    Section(
        SOLVES,
        "",
        "**Cold solves of the smooth punch**, each backend with its defaults and up to the size"
        " that it supports, with assembly and one elastic solve of the same mesh for comparison.",
        {
            "backend": ("label", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "unknowns": ("unknowns", "{:.0f}"),
            "seconds": ("seconds", ""),
            "elastic solves": ("elastic_solves", ""),
            "iterations": ("iterations", "{:.0f}"),
            "memory, MB": ("memory_mb", "{:.0f}"),
        },
    ),
    Section(
        ("soil",),
        "Time of soils with friction",
        "**Soil with friction compared with von Mises** on the same mesh with the same loads,"
        " solved alternately, from the problem to the certificate.",
        {
            "problem": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "unknowns": ("unknowns", "{:.0f}"),
            "seconds": ("seconds", ""),
            "iterations": ("iterations", "{:.0f}"),
            "iterations, von Mises": ("beside", "{:.0f}"),
            "largest residual": ("largest", "{:.0e}"),
            "time relative to von Mises": ("ratio", ""),
        },
    ),
    Section(
        ("wall",),
        "Time of walls of blocks",
        "**The certified loop on masonry walls** with windows and mu = 0.65 in all joints. Times"
        " are also given in units of one associated solve of the same wall. Memory is the peak"
        " minus that of the assembled problem.",
        {
            "wall": ("what", "{}"),
            "blocks": ("blocks", "{:.0f}"),
            "courses": ("courses", "{:.0f}"),
            "joints": ("joints", "{:.0f}"),
            "tolerance": ("tolerance", "{:.0e}"),
            "status": ("status", "{}"),
            "gap": ("gap", "{:.0e}"),
            "inner solves": ("solves", "{:.0f}"),
            "seconds": ("seconds", ""),
            "associated solves": ("ratio", ""),
            "memory, MB": ("memory_mb", "{:.0f}"),
        },
        ("blocks",),
    ),
    Section(
        ("wall peers",),
        "",
        "**The wall of 1 000 blocks by each backend**, in one run: one associated solve, and the"
        " whole loop.",
        {
            "backend": ("backend", "{}"),
            "associated, s": ("associated", ""),
            "loop, s": ("seconds", ""),
            "inner solves": ("solves", "{:.0f}"),
            "largest residual": ("residual", "{:.0e}"),
            "relative to clarabel": ("ratio", ""),
        },
    ),
    Section(
        ("path",),
        "Time of paths of large deformation",
        "**Paths**, all steps with their certificates. The earlier time is that of a loop that"
        " started each step from the associated state. Times are also given in units of one"
        " associated solve of the first step and of one elastic solve of its mesh.",
        {
            "path": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "steps": ("steps", "{:.0f}"),
            "inner solves": ("solves", "{:.0f}"),
            "largest gap": ("gap", "{:.0e}"),
            "seconds": ("seconds", ""),
            "earlier, s": ("before", ""),
            "associated solves": ("ratio", "{:.0f}"),
            "elastic solves": ("elastic_solves", "{:.0f}"),
        },
    ),
    Section(
        ("path peers",),
        "",
        "**The first steps of this path by each backend** that supports hardening, in one run.",
        {
            "backend": ("backend", "{}"),
            "steps": ("steps", "{:.0f}"),
            "inner solves": ("solves", "{:.0f}"),
            "largest gap": ("gap", "{:.0e}"),
            "seconds": ("seconds", ""),
            "relative to clarabel": ("ratio", ""),
        },
    ),
    Section(
        ("robustness", "programs"),
        "Reliability",
        "**Random programs of all classes.** A result is right if its recomputed residuals are at"
        " most 1e-6, or if its status, locked or unsafe, is proven. A result is wrong if the"
        " residuals refute it; `lacore.solve` does not report such a result. Large programs have"
        " at least 1 500 unknowns.",
        {
            "programs": ("what", "{}"),
            "backend": ("backend", "{}"),
            "count": ("programs", "{:.0f}"),
            "right": ("right", "{:.0f}"),
            "wrong": ("wrong", "{:.0f}"),
            "no answer": ("nothing", "{:.0f}"),
            "refused": ("refused", "{:.0f}"),
            "large": ("large", "{:.0f}"),
            "large, right": ("large_right", "{:.0f}"),
            "total seconds": ("seconds", ""),
        },
    ),
)
