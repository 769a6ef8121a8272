"""What a row is from: a change of what made it is seen, one of anything else is not."""

from importlib.metadata import PackageNotFoundError, version

import pytest

import lacore as la
from lacore.solvers.backend import load_backend
from lacore_verification.fuzz.drawn.cases import runs_of
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.store import provenance
from lacore_verification.harness.store.provenance import code_of, describe


@pytest.fixture
def changed(monkeypatch):
    """As if a package had another version."""
    real = provenance._version

    def change(name):
        def other(asked):
            return "changed" if asked == name else real(asked)

        monkeypatch.setattr(provenance, "_version", other)
        provenance.code_version.cache_clear()

    yield change
    provenance.code_version.cache_clear()


RUNS = {name: plan(["shear-patch"], [name], ["coarse"])[0] for name in ("clarabel", "ipopt")}


@pytest.mark.parametrize(
    ("package", "concerns"),
    [
        ("numpy", {"clarabel", "ipopt"}),
        ("clarabel", {"clarabel", "ipopt"}),  # it proves what regularised ones claim
        ("casadi", {"ipopt"}),
        ("highspy", set()),
    ],
)
def test_a_run_is_of_other_code_where_a_package_behind_it_has_changed(package, concerns, changed):
    before = {name: code_of(run) for name, run in RUNS.items()}
    changed(package)
    assert {name for name, run in RUNS.items() if code_of(run) != before[name]} == concerns


def test_random_problems_are_compared_with_other_backends(changed):
    (run,) = runs_of(["blocks"], 1, seed=1)
    before = code_of(run)
    changed("casadi")
    assert code_of(run) != before


def test_packages_of_the_backends_at_work_are_named():
    assert "casadi" not in describe(["clarabel"])["packages"]
    assert f"casadi {version('casadi')}" in describe(["ipopt"])["packages"]


@pytest.mark.parametrize("name", la.backend_names())
def test_packages_of_a_backend_are_those_that_it_needs(name):
    """A name that nothing installs has no version to record."""
    backend = load_backend(name)
    for package in backend.capabilities.packages:
        try:
            assert version(package)
        except PackageNotFoundError:
            assert backend.unavailable(), package


def test_a_run_is_of_other_code_where_its_backend_has_another_version(monkeypatch):
    """A backend may say its version itself, whatever packages it needs."""

    def codes():
        provenance.code_version.cache_clear()
        return {name: code_of(run) for name, run in RUNS.items()}

    before = codes()
    monkeypatch.setattr(type(load_backend("ipopt")), "version", lambda self: "changed")
    after = codes()
    monkeypatch.undo()
    provenance.code_version.cache_clear()
    assert after["clarabel"] == before["clarabel"]
    assert after["ipopt"] != before["ipopt"]
