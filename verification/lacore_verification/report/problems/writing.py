"""The files that `lacore solve` writes: report, tables, VTU, and a Python script."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryFile
from textwrap import indent

from lacore.files.problem.reading import Stated
from lacore.files.problem.script import script
from lacore.files.problem.varied import Varied
from lacore.reporting.errors import InputError
from lacore_verification.harness.store.provenance import describe
from lacore_verification.report.files import write
from lacore_verification.report.problems import more
from lacore_verification.report.problems.answers import ProblemResults, Status
from lacore_verification.report.problems.asking import Question
from lacore_verification.report.problems.page import page
from lacore_verification.report.problems.words import lines

# shares of a range that are unlikely to give another number of the file
_SHARES = (0.381966, 0.618034)
SCRIPT, STATE = "problem.py", "state.vtu"


def require_writable(folder: Path) -> None:
    """Raise `InputError` where files cannot be written: before anything is solved."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        why = f"cannot write there ({error.strerror or error})"
        raise InputError("--out", str(folder), why, "give another folder") from error


def written(
    stated: Stated, question: Question, answer: ProblemResults, folder: Path, doing: Status
) -> Path:
    """Write all files of the results, and return the path of the page."""
    files = {SCRIPT: "the same problem as a Python script"}
    write_text(folder / SCRIPT, as_python(stated, question, folder))
    (folder / STATE).unlink(missing_ok=True)  # from an earlier result
    if answer.state.point is not None:
        try:
            answer.state.to_vtu(folder / STATE)
        except InputError:
            (folder / STATE).unlink(missing_ok=True)  # incomplete file
            raise
        files[STATE] = "velocities and stresses for ParaView, in SI units"
    with doing("writing the report"):
        text = stated.source.file.read_text(encoding="utf-8-sig")
        machine = describe([question.backend])
        told = lines(answer, stated.units)
        return write(page(stated.title, answer, told, stated.units, files, text, machine), folder)


def as_python(stated: Stated, question: Question, folder: Path) -> str:
    """Return the problem and its requested analyses, as a script in a folder."""
    problem = script(stated.program, folder)
    paths = "from pathlib import Path\n\n" if "Path(__file__)" in problem else ""
    given = [f'backend="{question.backend}"']
    given += [f'coupling="{question.coupling}"'] if question.coupling else []
    ends = ["", f"state = la.solve(problem, {', '.join(given)})", "print(state)"]
    names = [name for name in more.ANALYSES if name in question.analyses]
    varying = [name for name in names if more.ANALYSES[name].varies]
    ends += more.calls(question, stated.problem, [own for own in names if own not in varying])
    if question.varied is not None:
        function = _function(question.varied, folder)
        ends += _along(question, function)
        ends += more.calls(question, stated.problem, varying if function else [])
    title = " ".join(stated.title.replace("\\", "/").replace('"', "'").split())
    head = f'"""{title}: from {stated.source.file.name}."""\n\n'
    return f"{head}{paths}import lacore as la\n\n{problem}" + "\n".join(ends) + "\n"


def _along(question: Question, function: str) -> Iterator[str]:
    """Yield a Python function for the problem at each value, and the calls of its analyses."""
    varied = question.varied
    assert varied is not None
    if not function:
        yield f"# Several numbers here follow from {varied.name}, so it varies in the file only."
        return
    yield f"\n\ndef problem_at(value):\n{indent(function, '    ')}    return problem\n\n"
    yield f"within = ({varied.low!r}, {varied.high!r})"
    if "critical" in question.analyses:
        yield f"target = {question.target!r}"


def _function(varied: Varied, folder: Path) -> str:
    """Return a script with ``value`` instead of the number; empty if more depends on it."""
    found = set()
    for share in _SHARES:
        value = float(f"{varied.low + share * (varied.high - varied.low):.9g}")
        text = script(varied.stated(value).program, folder)
        found.add(text.replace(repr(value), "value") if repr(value) in text else "")
    return found.pop() if len(found) == 1 else ""


def write_text(file: Path, text: str) -> None:
    """Write a file of a report; `InputError` where it cannot be written."""
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        why = f"cannot write there ({error.strerror or error})"
        raise InputError("--out", str(file), why, "give another folder") from error
