"""What the doctor finds, on an installation that is sound and on ones that are not."""

import time

import pytest

import lacore as la
from lacore.solvers.backend import load_backend
from lacore_backends.clarabel_socp import Clarabel
from lacore_verification.commands import doctor


class Hanging(Clarabel):
    """It never comes back, whatever its time limit."""

    name = "hanging"

    def prepare(self, program, options):
        time.sleep(1000)


class Upside(Clarabel):
    """Its velocities point the wrong way."""

    name = "upside"

    def prepare(self, program, options):
        program.reference_load[:] *= -1
        return super().prepare(program, options)


class Absent(Clarabel):
    name = "absent"

    def unavailable(self):
        return "not here: pip install absent"


@pytest.fixture
def of(monkeypatch):
    """Only the given backends are there."""

    def only(*backends):
        entries = [(backend.name, backend, backend.unavailable()) for backend in backends]
        monkeypatch.setattr(doctor, "all_backends", lambda: iter(entries))

    return only


def test_sound_missing_and_wrong(of):
    of(Clarabel(), Absent(), Upside())
    seen = []
    found = doctor.examine(seen.append)
    assert seen == ["clarabel", "absent", "upside"]
    states = {record["backend"]: record["self_test"] for record in found["backends"]}
    assert states == {"clarabel": "pass", "absent": "missing", "upside": "FAIL"}
    assert found["backends"][1]["remedy"] == "not here: pip install absent"
    assert "lacore conformance upside" in found["backends"][2]["remedy"]
    assert not found["healthy"]


def test_what_is_only_missing_is_healthy(of):
    of(Clarabel(), Absent())
    assert doctor.examine(lambda _: None)["healthy"]


def test_hanging_is_reported_and_the_others_are_tested(of, monkeypatch):
    monkeypatch.setattr(doctor, "LIMIT", 0.1)
    of(Hanging(), Clarabel())
    hanging, sound = doctor.self_tests(lambda _: None)
    assert hanging["self_test"] == "FAIL"
    assert "time limit" in hanging["remedy"]
    assert sound["self_test"] == "pass"


@pytest.mark.parametrize(
    ("found", "wanted", "good"),
    [
        ("1.16.0", "scipy>=1.16", True),
        ("1.9.3", "scipy>=1.16", False),
        ("1.17", "scipy>=1.16", True),
        ("2.0.0+cpu.1", "scipy>=2.0", True),
        ("0.1", "anything", True),
    ],
)
def test_versions_are_compared_by_number(found, wanted, good):
    assert doctor._new_enough(found, wanted) is good


def test_missing_and_old_packages_get_a_remedy(monkeypatch):
    monkeypatch.setattr(
        doctor,
        "_requirements",
        lambda: ["nowhere-to-be>=2.0", "numpy>=99", 'pytest; extra == "dev"'],
    )
    missing, old = doctor.packages()
    assert missing["found"] == "not installed"
    assert missing["remedy"] == "pip install 'nowhere-to-be>=2.0'"
    assert old["remedy"] == "pip install 'numpy>=99'"


def test_a_backend_that_cannot_be_loaded_is_listed(monkeypatch):
    def broken(name):
        if name == "clarabel":
            raise la.CapabilityError("backend 'clarabel' cannot be loaded: no module")
        return load_backend(name)

    monkeypatch.setattr(doctor, "load_backend", broken)
    entries = {name: missing for name, _, missing in doctor.all_backends()}
    assert entries["clarabel"].endswith("no module")
    record = doctor.backend_record("clarabel", None, entries["clarabel"])
    whole = doctor.backend_record("newton", load_backend("newton"), "")
    assert record.keys() == whole.keys()
