"""Every backend on the suite; the suite on its own numbers; and that it bites."""

from dataclasses import dataclass, field, fields, make_dataclass, replace
from functools import cache
from types import MappingProxyType

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.program.state import ProgramState, contact_force, internal_force
from lacore.reporting.status import Status
from lacore.solvers.backend import load_backend
from lacore_backends._cvxpy_solvers import SOLVERS
from lacore_verification import conformance
from lacore_verification.commands import doctor
from lacore_verification.conformance.judge import AMPLIFIED
from lacore_verification.conformance.programs import WORKED


@pytest.fixture(scope="module")
def process():
    with la.SolverProcess() as process:
        yield process


def examined(name, programs, process):
    backend = load_backend(name)
    if reason := backend.unavailable():
        pytest.skip(reason)
    isolated = backend.capabilities.isolated
    return conformance.run(
        name, programs=programs, on_start=print, process=process if isolated else None
    )


# Of a second and more; those of one like it are fast.
DEAR = {("slsqp", "one cone")}


@pytest.mark.parametrize("backend", la.backend_names())
def test_conforms(backend, process):
    quick = [program for program in conformance.EXERCISES if (backend, program) not in DEAR]
    findings = examined(backend, quick, process)
    assert set(findings.verdict) != {conformance.SKIPPED}
    assert not conformance.failures(findings)


@pytest.mark.slow
@pytest.mark.parametrize(("backend", "program"), sorted(DEAR))
def test_conforms_on_programs_that_take_long(backend, program, process):
    assert not conformance.failures(examined(backend, [program], process))


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_variants_conform(solver):
    backend = load_backend(f"cvxpy:{solver}")
    if reason := backend.unavailable():
        pytest.skip(reason)
    assert not conformance.failures(conformance.run(backend.name))


@pytest.mark.slow
def test_variants_of_solvers_that_are_not_known_here_conform():
    """What cvxpy finds installed, with the defaults of each."""
    ready = [name for name, _, missing in doctor.all_backends() if not missing and ":" in name]
    others = [name for name in ready if name.partition(":")[2] not in SOLVERS]
    failed = {name: conformance.failures(conformance.run(name)) for name in others}
    assert not any(failed.values()), failed


# The numbers by hand, proven without any solver.

COMPLETE = [
    worked
    for worked in WORKED
    if worked.status is Status.SOLVED
    and (worked.tangential_reaction is not None or not worked.program.contact.count)
    and (worked.mean_stress or not any(group.volumetric.nnz for group in worked.program.groups))
]


def by_hand(worked):
    groups, contact = worked.program.groups, worked.program.contact
    none = [None] * len(groups)

    def filled(values, shape):
        return np.zeros(shape) if values is None else np.asarray(values, float).reshape(shape)

    return ProgramState(
        velocity=np.array(worked.velocity, float),
        load_factor=worked.load_factor,
        stress=tuple(
            filled(values, (group.weights.size, group.dim))
            for values, group in zip(worked.stress or none, groups, strict=True)
        ),
        mean_stress=tuple(
            filled(values, group.volume_weights.size)
            for values, group in zip(worked.mean_stress or none, groups, strict=True)
        ),
        normal_reaction=filled(worked.normal_reaction, contact.count),
        tangential_reaction=filled(
            worked.tangential_reaction, (contact.count, contact.tangent_dim)
        ),
    )


@pytest.mark.parametrize("worked", COMPLETE, ids=lambda worked: worked.name)
def test_the_hand_calculation_is_a_limit_state(worked):
    certificate = certify(worked.program, by_hand(worked), worked.contact)
    for entry in fields(certificate):
        assert getattr(certificate, entry.name) < 1e-14, entry.name


@pytest.mark.parametrize("worked", COMPLETE, ids=lambda worked: worked.name)
def test_allowed_errors_are_derived(worked):
    """The sums by which a tolerance becomes an error of the value, as the judge says."""
    state = by_hand(worked)
    forces = np.abs(internal_force(worked.program, state)).sum()
    forces += np.abs(contact_force(worked.program, state)).sum()
    sums = 1 + abs(state.load_factor) + np.abs(state.velocity).sum() + forces
    assert 2 * sums <= AMPLIFIED * max(abs(state.load_factor), 1)


def test_most_of_the_table_is_proven():
    assert len(COMPLETE) >= 17


# Planted errors: each is found, and by the right check.


sound = cache(load_backend)


@dataclass(frozen=True)
class Planted:
    """A sound backend with something wrong in the answers, or in what it is told."""

    change: object = None
    told: object = None
    forced: tuple = ()
    of: str = "clarabel"
    kept: list = field(default_factory=list, compare=False)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(sound(object.__getattribute__(self, "of")), name)

    def prepare(self, program, options):
        options = replace(options, **dict(self.forced))
        return PlantedSolver(self, sound(self.of).prepare(program, options), program)


class PlantedSolver:
    def __init__(self, planted, solver, program):
        self.planted, self.solver, self.program = planted, solver, program

    def solve(self, contact):
        told = contact if self.planted.told is None else self.planted.told(self, contact)
        answer = self.solver.solve(told)
        return answer if self.planted.change is None else self.planted.change(self, answer)

    def close(self):
        self.solver.close()


def _unimportable():
    """A sound backend whose class no other process can import by its name."""
    return type("Local", (Planted,), {})(lambda _, answer: answer)


def in_point(**changes):
    def change(_, answer):
        point = answer.point
        if point is None:
            return answer
        new = {name: how(getattr(point, name)) for name, how in changes.items()}
        return replace(answer, point=replace(point, **new))

    return change


def in_values(**changes):
    def change(_, answer):
        values = answer.regularised
        if answer.point is None:
            return answer
        new = {name: how(values) for name, how in changes.items()}
        return replace(answer, regularised=replace(values, **new))

    return change


def minus(values):
    return -values


def minus_all(parts):
    return tuple(-part for part in parts)


def never_infeasible(solver, answer):
    if answer.point is not None:
        return answer
    program, contact = solver.program, solver.program.contact
    point = ProgramState(
        np.zeros(program.n),
        0.0,
        tuple(np.zeros((group.weights.size, group.dim)) for group in program.groups),
        tuple(np.zeros(group.weights.size) for group in program.groups),
        np.zeros(contact.count),
        np.zeros((contact.count, contact.tangent_dim)),
    )
    return replace(answer, status=Status.SOLVED, point=point)


def first_bounds_for_ever(solver, contact):
    if not hasattr(solver, "first"):
        solver.first = contact.bound
    return replace(contact, bound=solver.first)


def bounds_of_another(solver, contact):
    solver.planted.kept.append(solver.solver)
    solver.solver = solver.planted.kept[0]
    return contact


class Forgetful(Planted):
    """It does not look at the modulus, and says that it takes it."""

    @property
    def capabilities(self):
        return replace(sound(self.of).capabilities, hardening=True)

    def prepare(self, program, options):
        perfect = tuple(replace(group, modulus=None) for group in program.groups)
        return super().prepare(replace(program, groups=perfect), options)


class Weightless(Planted):
    """It takes soil for a metal as strong as soil is without pressure."""

    def prepare(self, program, options):
        plain = tuple(replace(group, surfaces=None) for group in program.groups)
        return super().prepare(replace(program, groups=plain), options)


def closed(_, contact):
    return replace(contact, shift=np.zeros(contact.shift.size))


def give_up(*_):
    raise RuntimeError("out of luck")


def almost(factor):
    return lambda value: value * factor


REGULARISED = {"of": "clarabel-regularised"}
WRONG = {
    "sign of friction": (
        Planted(in_point(tangential_reaction=minus)),
        "friction",
        "tangential reaction",
    ),
    "sign of pressure": (Planted(in_point(normal_reaction=minus)), "friction", "normal reaction"),
    "sign of stress": (Planted(in_point(stress=minus_all)), "one cone", "stress of body"),
    "sign of mean stress": (
        Planted(in_point(mean_stress=minus_all)),
        "volumetric row",
        "mean stress of body",
    ),
    "stress out of balance": (
        Planted(in_point(stress=lambda parts: tuple(part * (1 - 1e-5) for part in parts))),
        "one cone",
        "residuals",
    ),
    "value": (Planted(in_point(load_factor=almost(1 + 1e-5))), "friction", "load factor"),
    "velocity": (Planted(in_point(velocity=almost(1 + 1e-6))), "friction", "residuals"),
    "velocity without a sense": (
        Planted(in_point(velocity=lambda u: np.array([1.0, 0.8]) if u.size == 2 else u)),
        "friction",
        "velocity",
    ),
    "wrong shape": (
        Planted(in_point(tangential_reaction=np.ravel)),
        "friction in two directions",
        "status",
    ),
    "point of NaN": (Planted(in_point(velocity=almost(np.nan))), "friction", "status"),
    "never infeasible": (Planted(never_infeasible), "locked by stick", "status"),
    "never unbounded": (Planted(never_infeasible), "unsafe in plasticity", "status"),
    "no time limit": (Planted(forced=(("time_limit", 1e3),)), "time limit", "status"),
    "no iteration limit": (Planted(forced=(("max_iterations", 500),)), "iteration limit", "status"),
    "stale bounds": (Planted(told=first_bounds_for_ever), "repeated solves", "load factor"),
    "shared state": (Planted(told=bounds_of_another), "two solvers", "load factor"),
    "raises": (Planted(give_up), "friction", "raised"),
    "cannot be imported": (_unimportable(), "separate process", "class"),
    "no T19": (
        Planted(lambda _, answer: replace(answer, regularised=None), **REGULARISED),
        "friction",
        "status",
    ),
    "lambda of alpha_reg": (
        Planted(in_values(load_factor=lambda values: values.alpha_reg), **REGULARISED),
        "one cone",
        "lambda",
    ),
    "P of alpha_reg": (
        Planted(in_values(plastic=lambda values: values.alpha_reg), **REGULARISED),
        "one cone",
        "P recomputed",
    ),
    "multiplier": (
        Planted(in_values(multiplier=lambda values: values.plastic), **REGULARISED),
        "one cone",
        "multiplier",
    ),
    "another r": (Planted(forced=(("r", 0.011),), **REGULARISED), "friction", "minimum"),
    "another bulk": (
        Planted(forced=(("bulk", 900.0),), **REGULARISED),
        "volumetric row",
        "minimum",
    ),
    "pressure forgotten": (Weightless(), "Mohr-Coulomb", "load factor"),
    "hardening forgotten": (Forgetful(), "hardening shares the load", "load factor"),
    "hardening forgotten by highs": (
        Forgetful(of="highs"),
        "hardening up to a neighbour",
        "stress of body",
    ),
    "hardening forgotten by penalties": (
        Forgetful(of="newton"),
        "hardening shares the load",
        "minimum",
    ),
    "distance forgotten": (Planted(told=closed), "a distance that closes", "load factor"),
    "exact passed off": (
        Planted(in_values(alpha_reg=lambda values: values.load_factor), **REGULARISED),
        "friction",
        "alpha_reg recomputed",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_it_bites(name):
    wrong, program, check = WRONG[name]
    findings = conformance.run(wrong, programs=[program], on_start=print)
    found = findings[(findings.verdict == conformance.FAIL) & (findings.check == check)]
    assert len(found), findings
    assert f" on {found.program.iloc[0]!r}, {check}: " in found.message.iloc[0]


def test_a_sound_backend_planted_is_sound():
    """The plant itself changes nothing; but what does not hold of the backend it is made of."""
    programs = ["one cone", "friction", "locked by stick", "two solvers", "time limit"]
    assert not conformance.failures(conformance.run(Planted(), programs=programs))
    assert not conformance.failures(conformance.run(Planted(**REGULARISED), programs=programs))


def changed_class(**changes):
    """A backend whose declaration is changed."""

    class Changed(Planted):
        pass

    for name, value in changes.items():
        setattr(Changed, name, value)
    return Changed()


@pytest.mark.parametrize(
    ("changes", "program", "check"),
    [
        ({"title": ""}, "declaration", "title"),
        ({"version": lambda _: "newest"}, "declaration", "version"),
        ({"statuses": MappingProxyType({"fine": "solved"})}, "declaration", "statuses"),
        ({"statuses": {"Broken": Status.FAILED}}, "declaration", "solved"),
        (
            {"Options": make_dataclass("Lax", [("time_limit", float, 1.0)], frozen=True)},
            "options",
            "time_limit = -1",
        ),
        (
            {"Options": make_dataclass("Loose", [("time_limit", float, 1.0)])},
            "options",
            "frozen",
        ),
        (
            {"Options": make_dataclass("Endless", [("tolerance", float, 1.0)], frozen=True)},
            "options",
            "time_limit",
        ),
    ],
)
def test_it_reads_the_declaration(changes, program, check):
    findings = conformance.run(changed_class(**changes), programs=[program], on_start=print)
    assert check in set(findings.check[findings.verdict == conformance.FAIL])


def test_a_stated_tolerance_is_what_a_backend_is_judged_by():
    """Off by 1e-5: wrong at the tolerance of an interior-point method, right at 1e-6."""
    off = Planted(in_point(load_factor=almost(1 + 1e-5)))
    for tolerance, allowed in ((1e-10, 1e-7), (1e-6, 1e-4)):
        findings = conformance.run(off, {"tolerance": tolerance}, programs=["friction"])
        row = findings[findings.check == "load factor"].iloc[0]
        assert row.allowed == pytest.approx(allowed)
        assert (row.verdict == conformance.PASS) == (tolerance == 1e-6)


# One call for others.


def test_require_says_all_that_is_wrong():
    with pytest.raises(AssertionError) as caught:
        conformance.require(Planted(in_point(load_factor=almost(1 + 1e-5))))
    text = str(caught.value)
    assert (
        "clarabel on 'friction', load factor: load factor 5.5 was expected, 5.500055 came:"
        " 1e-05 off, 1e-07 allowed" in text
    )
    assert len(text.splitlines()) > 20


def test_unknown_names_get_a_hint():
    with pytest.raises(la.InputError, match="did you mean 'clarabel'"):
        conformance.run("clarbel")
    with pytest.raises(la.InputError, match="did you mean 'friction'"):
        conformance.run("clarabel", programs=["fiction"])


def test_beyond_capability_is_skipped_with_the_reason():
    findings = conformance.run("highs", programs=["one cone"])
    assert list(findings.verdict) == [conformance.SKIPPED]
    assert "takes linear programs" in findings.message[0]


def test_one_record_a_program():
    findings = conformance.run("clarabel", programs=["friction", "locked by stick"])
    first, second = conformance.by_program(findings)
    assert (first["program"], first["verdict"]) == ("friction", conformance.PASS)
    assert 0 <= first["value"] <= first["allowed"]
    assert second["closest"] == ""
