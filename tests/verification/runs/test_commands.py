"""Commands in reports run exactly the run of their row, and export its program."""

import shlex

import click
import pytest

from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.commands import cli
from lacore_verification.harness.campaigns import comparison, overview, sweep
from lacore_verification.harness.campaigns.backend_options import with_options
from lacore_verification.runs.commands import commands_of


def arguments(command):
    """Options and arguments of a command, as lacore reads them."""
    program, name, *words = shlex.split(command)
    assert program == "lacore"
    own = cli.main.get_command(click.Context(cli.main), name)
    return name, own.make_context(name, words).params


def planned(command):
    """The runs of a command, by their keys."""
    name, given = arguments(command)
    names, backends, meshes, couplings = (
        given[one] for one in ("cases", "backends", "meshes", "couplings")
    )
    if name == "compare":
        runs = comparison.plan(names, backends, meshes, couplings)
    else:
        runs = sweep.plan(names, given["vary"], backends, meshes, couplings)
    return {run.key: run for run in runs}


def check(run):
    """The command plans the run, and no other but the associated one next to a default."""
    runs = planned(commands_of(run)["repeat_command"])
    assert run.key in runs, commands_of(run)
    assert {one.coupling for one in runs.values()} <= {run.coupling, "associated"}
    assert len(runs) <= 2


@pytest.mark.parametrize(
    ("names", "meshes", "couplings"),
    [
        (["deformable-block:sliding", "wall-1:mu-0.65"], ["coarse"], []),
        (["prandtl-punch"], [], ["associated", "reaction-raw"]),
        (["prandtl-punch:smooth"], ["coarse"], ["bracket"]),
        (["hardening-cylinder:voce"], [], []),
    ],
)
def test_a_run_of_a_comparison_is_repeated(names, meshes, couplings):
    runs = comparison.plan(names, ["clarabel", "newton"], meshes, couplings)
    assert runs
    for run in runs:
        check(run)


@pytest.mark.parametrize(
    ("name", "axes"),
    [
        ("deformable-block:sliding", ["mu=0.15,0.3", "damping=0.3,1"]),
        ("prandtl-punch:smooth", ["r=1e-1:1e-3:3:log"]),
        ("wall-1", ["mu=0.4,0.5"]),
        ("hardening-cylinder:voce", ["steps=5,7", "scheme=leapfrog"]),
        ("block-slide", ["mu=0.25"]),
    ],
)
def test_a_run_of_a_sweep_is_repeated(name, axes):
    runs = sweep.plan([name], axes, ["clarabel", "newton"], ["coarse"])
    assert len(runs) > 1
    for run in runs:
        found = planned(commands_of(run)["repeat_command"])
        assert list(found) == [run.key], commands_of(run)


def test_the_program_of_a_listed_variant_is_exported():
    (run,) = comparison.plan(["prandtl-punch:smooth"], ["clarabel"], ["coarse"])
    found = commands_of(run)
    assert found["export_command"] == "lacore export prandtl-punch:smooth --meshes coarse"
    assert found["instance_file"] == "prandtl-punch-smooth-coarse.npz"
    name, given = arguments(found["export_command"])
    assert (name, given["cases"]) == ("export", ("prandtl-punch:smooth",))


def test_a_program_that_cannot_be_exported_has_no_command():
    (run, *_) = sweep.plan(["deformable-block:sliding"], ["mu=0.15"], ["clarabel"], ["coarse"])
    found = commands_of(run)
    assert found["export_command"] == found["instance_file"] == ""


def test_the_brackets_of_the_selection_have_no_command_of_their_own():
    """Their target width is that of the selection, which no option sets."""
    runs = [run for run in overview.overview((), (), catalogue()) if run.coupling == "bracket"]
    assert runs
    assert {commands_of(run)["repeat_command"] for run in runs} == {""}


def test_a_run_with_changed_options_is_repeated():
    runs = comparison.plan(["prandtl-punch:smooth"], ["clarabel"], ["coarse"])
    (run,) = with_options(runs, ["clarabel.tolerance=1e-6"])
    assert list(planned(commands_of(run)["repeat_command"])) == [run.key]
