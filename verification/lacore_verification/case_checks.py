"""Check every case with pytest.

The command is ``pytest verification`` in the folder of the repository, and otherwise ``pytest
--pyargs lacore_verification.case_checks``. There is one test for each case, backend and
check, such as ``prandtl-punch:smooth-clarabel-order``; cases of installed packages are
included. A run that several checks need is done once, and only if a selected test needs it.
"""

from collections.abc import Iterator
from functools import partial

import pytest

from lacore_verification.catalogue.plugins import gather
from lacore_verification.defaults import cores
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.perform.processes import run_in_processes
from lacore_verification.harness.store.store import NAME
from lacore_verification.harness.verdicts.words import NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from lacore_verification.harness.verify import Finished, Question, answer, ask, finish, runs_of

KNOWN = gather()


def test_cases_of_packages_can_be_loaded() -> None:
    """Cases that cannot be loaded would not be tested."""
    assert not KNOWN.broken, "; ".join(map(str, KNOWN.broken.values()))


@pytest.fixture(scope="session")
def finished(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Finished:
    """Run all runs of the selected tests."""
    asked = list(_selected(request.session))
    store = tmp_path_factory.mktemp("verification") / NAME
    return finish(
        asked, run_all(runs_of(asked), store, executor=partial(run_in_processes, jobs=cores()))
    )


def _selected(session: pytest.Session) -> Iterator[Question]:
    for item in session.items:
        if isinstance(item, pytest.Function) and item.originalname == test_case.__name__:
            question = item.callspec.params.get("question")
            if isinstance(question, Question):
                yield question


@pytest.mark.parametrize("question", ask(known=KNOWN), ids=lambda question: question.name)
def test_case(question: Question, finished: Finished) -> None:
    """Check one case with a backend."""
    found = answer(question, finished)
    if found.verdict in (SKIPPED, NO_RESULT, NO_REFERENCE):
        pytest.skip(found.why)
    assert found.verdict == PASS, found.why
