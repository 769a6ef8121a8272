"""The questions that docs/benchmarks.md answers, and the columns of its tables."""

from collections.abc import Mapping
from dataclasses import dataclass

SOLVES = ("assembly", "elastic", "solve")
"""Benchmarks of the punch by backends with their own defaults, and what they stand beside."""
Columns = Mapping[str, tuple[str, str]]
"""Of a table: field of a record, and its format; none: two digits."""


@dataclass(frozen=True)
class Section:
    """A question, and the table that answers it.

    Attributes:
        kinds: of the records that it shows; those with a list of runs show each of them.
        heading: above it; none: it goes on with the section before.
        text: what its figures are.
        columns: of the table.
        order: the columns that rows are sorted by.
    """

    kinds: tuple[str, ...]
    heading: str
    text: str
    columns: Columns
    order: tuple[str, ...] = ()


SECTIONS = (
    Section(
        ("held",),
        "What lacore is held to",
        "Figures that were asked for before they were reached, at most or at least, and what was"
        " measured; an aim is what was hoped for. By the clock two bounds at a time on two cores;"
        " all else is processor time on one thread, or a ratio of it in the same run.",
        {
            "figure": ("what", "{}"),
            "asked": ("bar", "{}"),
            "aim": ("aim", "{}"),
            "measured": ("measured", "{}"),
            "holds": ("holds", "{}"),
        },
    ),
    Section(
        ("bracket",),
        "How long does a proof take?",
        "**Brackets**, from the start to the certificate, all solves and refinements included:"
        " processor time of one bound at a time, which elastic solves of the last mesh of the upper"
        " bound count, too; and time by the clock of two at a time, which find the same.",
        {
            "bracket": ("what", "{}"),
            "lower": ("lower", "{:.5f}"),
            "upper": ("upper", "{:.5f}"),
            "width": ("width", "{:.3%}"),
            "triangles below": ("triangles_lower", "{:.0f}"),
            "above": ("triangles_upper", "{:.0f}"),
            "solves": ("solves", "{:.0f}"),
            "seconds": ("seconds", ""),
            "elastic solves": ("elastic_solves", "{:.0f}"),
            "two at a time, s by the clock": ("wall", ""),
            "their processor s": ("of_both", ""),
        },
        ("problem", "-width"),
    ),
    Section(
        ("bracket peers",),
        "",
        "**The same brackets by each backend**, one bound at a time, in one run. `cvxpy` is"
        " Clarabel through cvxpy, without what lacore knows of units of rows: at the same nominal"
        " tolerance it leaves larger gaps, and so needs more elements, or stops at the most there"
        " may be.",
        {
            "bracket": ("what", "{}"),
            "backend": ("backend", "{}"),
            "width": ("width", "{:.3%}"),
            "ending": ("ending", "{}"),
            "solves": ("solves", "{:.0f}"),
            "seconds": ("seconds", ""),
            "times auto": ("ratio", ""),
        },
    ),
    Section(
        ("true gap",),
        "How long does one solve take?",
        "**Upper bounds of the smooth punch at the same true gap**, 1e-5 at most: what lies between"
        " the dissipation of the velocity and the load of the stresses, recomputed. Tolerances are"
        " the loosest that leave so much of three that were tried; doubt is by how much the load"
        " could be off if all that is left counted against it. Memory is the peak of the process.",
        {
            "backend": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "unknowns": ("unknowns", "{:.0f}"),
            "tolerance": ("tolerance", "{:.0e}"),
            "true gap": ("gap", "{:.0e}"),
            "doubt": ("doubt", "{:.0e}"),
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
        "**Cold solves of the smooth punch**, each backend with its own defaults, as far as it"
        " goes, beside assembly and one elastic solve of the same mesh.",
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
        "What does friction of soils cost?",
        "**Soil beside von Mises** on the same mesh, with the same loads, in turns, from the"
        " problem to the certificate.",
        {
            "problem": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "unknowns": ("unknowns", "{:.0f}"),
            "seconds": ("seconds", ""),
            "iterations": ("iterations", "{:.0f}"),
            "of von Mises": ("beside", "{:.0f}"),
            "largest residual": ("largest", "{:.0e}"),
            "time per von Mises": ("ratio", ""),
        },
    ),
    Section(
        ("wall",),
        "How long does a wall of blocks take?",
        "**The certified loop on masonry walls** with windows, mu = 0.65 in all joints, in units of"
        " one associated solve of the same wall; memory is the peak above that of the assembled"
        " problem.",
        {
            "wall": ("what", "{}"),
            "blocks": ("blocks", "{:.0f}"),
            "courses": ("courses", "{:.0f}"),
            "joints": ("joints", "{:.0f}"),
            "asked": ("tolerance", "{:.0e}"),
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
        "**The wall of 1 000 by each backend**, in one run: one associated solve, and the loop.",
        {
            "backend": ("backend", "{}"),
            "associated, s": ("associated", ""),
            "loop, s": ("seconds", ""),
            "inner solves": ("solves", "{:.0f}"),
            "largest residual": ("residual", "{:.0e}"),
            "times clarabel": ("ratio", ""),
        },
    ),
    Section(
        ("path",),
        "How long does a path of large deformation take?",
        "**Paths**, all steps with their certificates, beside the time before, of the loop that"
        " began each step at the associated state, in units of one associated solve of the first"
        " step and of one elastic solve of its mesh.",
        {
            "path": ("what", "{}"),
            "triangles": ("triangles", "{:.0f}"),
            "steps": ("steps", "{:.0f}"),
            "inner solves": ("solves", "{:.0f}"),
            "largest gap": ("gap", "{:.0e}"),
            "seconds": ("seconds", ""),
            "before, s": ("before", ""),
            "associated solves": ("ratio", "{:.0f}"),
            "elastic solves": ("elastic_solves", "{:.0f}"),
        },
    ),
    Section(
        ("path peers",),
        "",
        "**The first steps of that path by each backend** that takes hardening, in one run.",
        {
            "backend": ("backend", "{}"),
            "steps": ("steps", "{:.0f}"),
            "inner solves": ("solves", "{:.0f}"),
            "largest gap": ("gap", "{:.0e}"),
            "seconds": ("seconds", ""),
            "times clarabel": ("ratio", ""),
        },
    ),
    Section(
        ("robustness", "programs"),
        "How often does a backend answer?",
        "**Random programs of all classes**, right by residuals within 1e-6 that are recomputed, or"
        " by a word, locked or unsafe, that is proven. Wrong is a claim that they refute, which"
        " `lacore.solve` does not give out. Large ones have 1 500 unknowns or more.",
        {
            "programs": ("what", "{}"),
            "backend": ("backend", "{}"),
            "asked": ("programs", "{:.0f}"),
            "right": ("right", "{:.0f}"),
            "wrong": ("wrong", "{:.0f}"),
            "no answer": ("nothing", "{:.0f}"),
            "refused": ("refused", "{:.0f}"),
            "large": ("large", "{:.0f}"),
            "of them right": ("large_right", "{:.0f}"),
            "seconds of all": ("seconds", ""),
        },
    ),
)
