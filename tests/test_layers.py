"""Order of the packages, and what each may import (DESIGN)."""

import ast
import importlib.util
import re
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from functools import cache
from graphlib import TopologicalSorter
from importlib.metadata import packages_distributions
from itertools import chain
from pathlib import Path
from pkgutil import resolve_name

import pytest

from lacore.reporting import views

ROOT = Path(__file__).parents[1]
MOST_FILES, MOST_LINES, MOST_ENTERED = 16, 400, 15
MOST_PACKAGES, MOST_LAYERS = 20, 11
MOST_QUESTIONS = 6
KINDS_OF_THINGS = {
    *("Body", "BlockAssembly", "Frame", "BodyDofs", "RigidDofs", "FrameDofs", "EquilibriumDofs"),
    *("PointForce", "BodyForce", "RigidFooting", "Traction", "Pressure", "RigidObstacle"),
}
PLACES = {
    "lacore": ROOT / "lacore",
    "lacore_backends": ROOT / "backends" / "lacore_backends",
    "lacore_verification": ROOT / "verification" / "lacore_verification",
}
LACORE = (
    *("reporting", "numerics", "program", "solvers", "coupling", "model", "assembly", "limit"),
    *("bounds", "analyses", "paths", "files", "pictures"),
)
"""Files and folders of lacore: each imports from those before it, and from its own."""
VERIFICATION = (
    *("defaults", "usage", "case", "cases", "runs", "catalogue", "fuzz", "harness", "report"),
    *("conformance", "commands", "__main__", "case_checks"),
)
"""Those of verification, alike."""
ORDERS = {"lacore": LACORE, "lacore_verification": VERIFICATION}
SOLVER_WING = LACORE[LACORE.index("solvers") : LACORE.index("model")]
MECHANICS_WING = LACORE[LACORE.index("model") : LACORE.index("limit")]
NAMED = r"lacore[\w.]*:\w+"
SOLVERS = ("casadi", "clarabel", "cvxpy", "ecos", "highspy", "mosek", "osqp", "qoco", "scs")


@dataclass(frozen=True)
class Contents:
    """What the rules ask of a file, found in one pass over its syntax tree."""

    imported: list[str]  # packages and full names, wherever in the file, also as ``module:name``
    constants: set[object]
    kind_checks: dict[int, str]  # by line, calls of isinstance that name a KINDS_OF_THINGS


@cache
def contents(path):
    found = Contents([], set(), {})
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        found.imported.extend(imported_by(node, path))
        if isinstance(node, ast.Constant):
            found.constants.add(node.value)
        elif isinstance(node, ast.Call) and asks_for_a_kind(node):
            found.kind_checks[node.lineno] = ast.unparse(node)
    return found


def imported_by(node, path):
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0, f"{path}: a relative import"
        return [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    if isinstance(node, ast.Constant) and re.fullmatch(NAMED, str(node.value)):
        return [node.value.replace(":", ".")]
    return []


def asks_for_a_kind(call):
    if not (isinstance(call.func, ast.Name) and call.func.id == "isinstance"):
        return False
    named = {own.id for own in ast.walk(call.args[1]) if isinstance(own, ast.Name)}
    return bool(named & KINDS_OF_THINGS)


def imports(path):
    return contents(path).imported


def files(package):
    """Return the Python files of a package; without any, a check would pass without a test."""
    top, *inside = package.split(".")
    found = sorted(PLACES[top].joinpath(*inside).rglob("*.py"))
    assert found, f"no files in {package}"
    return found


def offenders(paths, names_of):
    """Return the offending names by file, for all files that have any."""
    found = {str(path.relative_to(ROOT)): sorted(names_of(path)) for path in paths}
    return {path: names for path, names in found.items() if names}


def imports_within(packages, ignored=()):
    """Return a function that lists what a file imports from some packages."""

    def names_of(path):
        return [
            name
            for name in imports(path)
            if any(within(name, package) for package in packages) and not name.startswith(ignored)
        ]

    return names_of


def within(name, package):
    return name == package or name.startswith(f"{package}.")


def test_the_core_knows_no_solver_and_no_case():
    banned = ("lacore_backends", "lacore_verification", *SOLVERS)
    assert offenders(files("lacore"), imports_within(banned)) == {}


@pytest.mark.parametrize("top", ORDERS)
def test_imports_run_one_way(top):
    """Wherever in a file they stand; of `from package import subpackage` the latter counts."""
    order = ORDERS[top]

    def imported_from_later(path):
        own = package_of(path)
        if own == "__init__":
            return []  # the face
        return [name for name in packages_seen(path, top) if order.index(name) > order.index(own)]

    assert offenders(files(top), imported_from_later) == {}


def test_what_knows_no_mesh_and_what_knows_no_loop_meet_in_limit():
    for wing, other in ((SOLVER_WING, MECHANICS_WING), (MECHANICS_WING, SOLVER_WING)):
        own = [path for path in files("lacore") if package_of(path) in wing]
        seen = offenders(own, lambda path, other=other: packages_seen(path, "lacore") & set(other))
        assert seen == {}


@pytest.mark.parametrize(
    "view", [views.picture, views.section, views.animation, views.files, views.scene]
)
def test_every_view_names_a_type_and_its_maker(view):
    """It names both sides; of a class or a function that was renamed nobody would notice."""
    assert view.makers
    for kind, maker in view.makers.items():
        assert isinstance(resolve_name(kind), type)
        assert callable(resolve_name(maker))


@pytest.mark.parametrize("top", ORDERS)
def test_every_package_has_its_place(top):
    there = {package_of(path) for path in files(top)}
    assert there - {"__init__"} == set(ORDERS[top])


@pytest.mark.parametrize("top", ORDERS)
def test_packages_are_few_and_on_few_layers(top):
    """A layer above all that a package imports, in functions and for type checkers too."""
    assert len(ORDERS[top]) <= MOST_PACKAGES
    assert max(layers(top).values()) <= MOST_LAYERS


def layers(top):
    """The layer of each package, from 1 at the bottom; a cycle raises `CycleError`."""
    needs = {name: set() for name in ORDERS[top]}
    for path in files(top):
        if (own := package_of(path)) != "__init__":
            needs[own] |= packages_seen(path, top) - {own, "__init__"}
    found = {}
    for name in TopologicalSorter(needs).static_order():
        found[name] = 1 + max((found[other] for other in needs[name]), default=0)
    return found


def package_of(path):
    """The file or folder of its top-level package that a file is or lies in."""
    return module_of(path).split(".")[1]


def packages_seen(path, top):
    """The files and folders of a top-level package that a file imports from; not the version."""
    seen = {name.split(".")[1] for name in imports(path) if name.startswith(f"{top}.")}
    return seen - {"__version__"}


@pytest.mark.parametrize("top", PLACES)
def test_modules_have_no_cycles(top):
    """Imports in functions and for type checkers count."""
    found = {module_of(path): path for path in files(top)}
    needs = {
        name: {known(seen, found) for seen in imports(path)} - {name, None}
        for name, path in found.items()
        if not name.endswith("__init__")
    }
    TopologicalSorter(needs).prepare()  # CycleError names the files of a circle


def module_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[parts[0] != "lacore" :])


def known(name, found):
    """The module that holds a name, if it is one of those."""
    return next((n for n in (name, name.rpartition(".")[0]) if n in found), None)


@pytest.mark.parametrize("top", ORDERS)
def test_folders_and_files_are_short(top):
    """Cases are as many as there are."""
    crowded, long = {}, {}
    for folder in {path.parent for path in files(top)}:
        held = list(folder.glob("*.py"))
        if len(held) > MOST_FILES and folder.name != "cases":
            crowded[str(folder.relative_to(ROOT))] = len(held)
        for path in held:
            lines = len(path.read_text(encoding="utf-8").splitlines())
            if lines > MOST_LINES:
                long[str(path.relative_to(ROOT))] = lines
    assert not crowded
    assert not long


def test_few_ask_what_kind_of_thing_they_have():
    """Bodies, loads and obstacles say by their protocols what is asked of them, or one function a
    kind is registered: a new kind is not searched for in all files."""
    asked = {
        f"{path.relative_to(ROOT)}:{line}": text
        for path in files("lacore")
        for line, text in contents(path).kind_checks.items()
    }
    assert len(asked) <= MOST_QUESTIONS, asked


def test_the_list_of_slow_tests_names_tests():
    """Of one that was renamed nobody would notice that it is fast again."""
    for line in (ROOT / "tests" / "slow.txt").read_text(encoding="utf-8").splitlines():
        file, _, name = line.partition("::")
        function = name.partition("[")[0]
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8") or not name, line


def test_pictures_of_the_packages_are_those_of_the_code():
    """Drawn by docs/architecture.py, which reads the lists above and the imports."""
    for name, drawn in script_of("architecture").pictures().items():
        kept = (ROOT / "docs" / name).read_text(encoding="utf-8")
        assert kept == drawn, (
            f"docs/{name} shows other packages or imports: run python docs/architecture.py"
        )


def test_a_solve_passes_through_few_packages():
    """Counted by docs/entries.py; the flat files of the contract are one."""
    assert script_of("architecture").passed() <= MOST_ENTERED


def script_of(name):
    """A script of docs, as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


def test_a_backend_knows_the_core_only():
    """And private modules beside it, which are no backends: what several share exists once."""
    banned = ("lacore_backends", "lacore_verification", "skfem", "matplotlib")
    shared = ("lacore_backends._",)
    assert offenders(files("lacore_backends"), imports_within(banned, ignored=shared)) == {}


STABLE = (
    *("lacore.program", "lacore.program.state", "lacore.program.certificate"),
    *("lacore.program.regularization", "lacore.solvers.backend", "lacore.numerics.arrays"),
    *("lacore.reporting.status", "lacore.reporting.errors"),
)
"""Modules from which external backends import, as docs/architecture.md lists them."""
SHARED = ("lacore.program", "lacore.solvers", "lacore.numerics", *STABLE)
"""Packages and modules from which the backends of lacore import."""


def modules_beyond(allowed):
    """Return a function that lists the modules of lacore which a file imports from elsewhere."""

    def names_of(path):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        nodes = (own for own in ast.walk(tree) if isinstance(own, ast.ImportFrom))
        return [
            node.module
            for node in nodes
            if within(node.module, "lacore") and not allowed(node.module)
        ]

    return names_of


def test_an_external_backend_imports_from_stable_modules():
    example = sorted((ROOT / "examples" / "lacore-ecos").glob("*.py"))
    assert example
    assert offenders(example, modules_beyond(STABLE.__contains__)) == {}
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    paragraph = page.partition("External backends import only")[2].partition(
        "These paths are stable"
    )[0]
    assert all(name in paragraph or name.rpartition(".")[2] in paragraph for name in STABLE)


def test_the_backends_of_lacore_import_from_few_packages():
    def shared(module):
        return any(within(module, package) for package in SHARED)

    assert offenders(files("lacore_backends"), modules_beyond(shared)) == {}

    def public(module):
        return module != "lacore.program.kinematic"  # its names are those of lacore.program

    assert offenders(files("lacore_backends"), modules_beyond(public)) == {}


def test_a_case_knows_no_backend():
    banned = ("lacore_backends", *SOLVERS)
    assert offenders(files("lacore_verification.cases"), imports_within(banned)) == {}


def test_the_harness_knows_no_backend_by_name():
    """Cases say what cannot solve them, random problems what their second opinion is."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    names = set(tomllib.loads(text)["project"]["entry-points"]["lacore.backends"])

    def named(path):
        return names & contents(path).constants

    own = [
        path for path in files("lacore_verification") if package_of(path) not in ("cases", "fuzz")
    ]
    assert offenders(own, named) == {}


OTHERS = ("lacore_backends", "lacore_verification")
HEAVY = (
    *("matplotlib", "pandas", "scipy", "skfem", "shapely", "meshio", "pypardiso", "PIL", "ezdxf"),
    "numba",
    *("cvxpy", "casadi", "clarabel", "highspy", "dask", "distributed"),
    *("playwright", "jinja2", "rich", "IPython"),
)
"""What takes a tenth of a second or more to load; together they take several."""


@pytest.mark.parametrize(
    ("code", "more"),
    [
        ("import lacore", ("numpy", "lacore.reporting.errors", *OTHERS)),
        ("import lacore.solvers.child_process", ("numpy", *OTHERS)),
        ("import lacore.solvers.isolation", ("pandas", "skfem", *OTHERS)),
        ("import lacore as la; dir(la); la.InputError; la.Status", ("lacore.limit.solve",)),
        ("import lacore_verification.__main__", ("numpy", "lacore", "lacore_backends", "click")),
    ],
)
def test_names_load_what_they_need_only(code, more):
    banned = [*more, *(name for name in HEAVY if "isolation" not in code or name != "scipy")]
    assert loaded_of(code, banned) == []


def test_help_and_slips_of_the_keyboard_load_nothing_that_solves_or_draws():
    """One after the other: none of them does."""
    asked = [
        ["--help"],
        ["compar"],
        ["compare", "--help"],
        ["compare", "prandl-punch"],
        ["verify", "prandl-punch"],
        ["sweep", "wall-9", "--vary", "mu=0.1,0.2"],
        ["manual", "prandl-punch"],
        ["fuzz", "--help"],
    ]
    call = f"""
from lacore_verification.commands.cli import main
for arguments in {asked!r}:
    try:
        main(arguments)
    except SystemExit:
        pass"""
    banned = [
        *HEAVY,
        "lacore_backends",
        "lacore.limit.solve",
        "lacore_verification.harness.perform.processes",
    ]
    assert loaded_of(call, [*banned, "lacore_verification.cases.prandtl_punch"]) == []


def test_every_name_that_lacore_promises_is_there():
    """Also where a function has the name of its module, and that was imported before."""
    code = """
import lacore.analyses.ranges.coulomb, lacore.bounds.gap_identity, lacore.paths.sequential
import lacore as la
from types import ModuleType
found = {name: getattr(la, name) for name in la.__all__}
print(sorted(name for name, value in found.items() if isinstance(value, ModuleType)))
"""
    bodies = ["hardening", "masonry", "masonry3d", "meshes", "sections", "shapes"]
    assert printed_by(code) == str(["examples", bodies[0], "hooks", *bodies[1:], "types"])


def loaded_of(code, banned):
    """Which of some modules a fresh interpreter has loaded after running code."""
    asked = f"import sys; print([name for name in {banned!r} if name in sys.modules])"
    return ast.literal_eval(printed_by(f"{code}\n{asked}").splitlines()[-1])


def printed_by(code):
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return run.stdout.strip()


@pytest.mark.parametrize("package", PLACES)
def test_what_is_imported_is_installed_with_us(package):
    """Packages of others are named in pyproject.toml; this environment may have them by luck."""
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [*stated["dependencies"], *chain(*stated["optional-dependencies"].values())]
    named = {_normal(re.split(r"[^\w.-]", line)[0]) for line in lines}
    owners = owners_of_packages()
    missing = {
        f"{path.relative_to(ROOT)}: {top}"
        for path in files(package)
        for top in {name.split(".")[0] for name in imports(path)}
        if top not in (*sys.stdlib_module_names, *PLACES)
        and not named & set(map(_normal, owners.get(top, [top])))
    }
    assert not missing


@cache
def owners_of_packages():
    return packages_distributions()


def _normal(distribution):
    return distribution.lower().replace("_", "-")
