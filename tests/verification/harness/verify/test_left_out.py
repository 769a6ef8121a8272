"""What `lacore verify` leaves out where nothing is named: dear, and of variants like others."""

import pytest

from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import Catalogue, catalogue
from lacore_verification.harness.campaigns.comparison import capabilities, is_regularised
from lacore_verification.harness.campaigns.overview import shown_first
from lacore_verification.harness.verify import ask, left_out, runs_of
from tests.verification.command_line import lacore


@pytest.fixture(scope="module")
def few():
    """A case with a path, one on meshes, one of soil, one of rigid bodies."""
    ids = ("hardening-sphere", "platens-square", "cavity-cylinder", "wall-1")
    return Catalogue({name: catalogue()[name] for name in ids}, dict.fromkeys(ids, "test"))


def test_dear_backends_are_asked_about_further_variants_by_name_only(few):
    """They leave no variant, and no backend, without an answer."""
    short, whole = runs_of(ask(known=few)), runs_of(ask([*few], known=few))
    left = {run.key for run in whole} - {run.key for run in short}
    assert left == {run.key for run in left_out(known=few)} > set()
    assert not {run.key for run in short} - {run.key for run in whole}
    for run in (run for run in whole if run.key in left):
        assert run.variant not in shown_first(run.case)
        path = run.case.path is not None
        if run.coupling == BRACKET:
            continue
        further = not is_regularised(run.backend) and run.backend != "clarabel"
        can = capabilities(run.backend)
        least = can.dense or further or (can.slow_surfaces and run.case.surfaces)
        assert is_regularised(run.backend) if path else least
        assert run.case.meshed
    for told in (
        lambda run: (run.case.id, run.variant.name),
        lambda run: (run.case.id, run.backend),
    ):
        assert {told(run) for run in short} == {told(run) for run in whole}


def test_nothing_is_left_out_of_what_is_named(few):
    assert not left_out(["platens-square"], known=few)
    assert not left_out([], ["slsqp"], known=few)
    assert not left_out([], [], ["coarse"], known=few)


def test_all_and_a_case_are_one_too_many():
    done = lacore("verify", "wall-1", "--all")
    assert done.exit_code == 2
    assert "--all" in done.stderr
    assert "omit one of them" in done.stderr
