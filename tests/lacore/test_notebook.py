"""A notebook that is really run, in a kernel of its own."""

import pytest

CELLS = (
    "import lacore as la\nfrom tests.lacore.models import punch\nproblem = punch(2, 2)\nproblem",
    "state = la.solve(problem)\nstate",
    "below, above = la.lower_bound(problem), la.upper_bound(problem)\nbelow",
    "la.gap_identity(above, below)",
    "la.bracket(problem, 0.2)",
    "print(repr(state))",
)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of the client, of its own parts
def test_objects_are_shown_with_their_pictures():
    nbformat, nbclient = map(pytest.importorskip, ("nbformat", "nbclient"))
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    notebook = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    *shown, printed = notebook.cells
    for cell, title in zip(
        shown, ("Problem", "LimitState", "LowerBound", "GapIdentity", "Bracket"), strict=True
    ):
        (output,) = cell.outputs  # one, so that no figure comes by another way besides
        assert output.data["text/plain"].startswith(f"{title}: ")
        assert len(output.data["text/plain"]) <= 600
        assert f"{title}: " in output.data["text/html"]
        assert output.data["text/html"].count("data:image/png;base64,") == 1
    assert printed.outputs[0].text.startswith("LimitState: load factor 9.12")
