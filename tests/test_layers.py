"""The rooms of the house and who may enter which (DESIGN)."""

import ast
import importlib.util
import re
import subprocess
import sys
import tomllib
from functools import cache
from graphlib import TopologicalSorter
from importlib.metadata import packages_distributions
from itertools import chain
from pathlib import Path
from pkgutil import resolve_name

import pytest

from lacore import views

ROOT = Path(__file__).parents[1]
MOST_FILES, MOST_LINES, MOST_ROOMS = 16, 400, 15
MOST_QUESTIONS = 6
KINDS_OF_THINGS = {
    *("Body", "BlockAssembly", "Frame", "BodyDofs", "RigidDofs", "FrameDofs", "EquilibriumDofs"),
    *("PointForce", "BodyForce", "RigidFooting", "Traction", "Pressure", "RigidObstacle"),
}
ROOMS = ("lacore", "lacore_start", "backends", "verification")
LACORE = (
    *(
        "arrays",
        "errors",
        "numerics",
        "showing",
        "views",
        "status",
        "surfaces",
        "dissipation",
        "program",
        "reduction",
    ),
    *("state", "part_forces", "certificate", "regularization", "backend"),
    *("process", "inner", "claims", "coupling"),
    *("materials", "conditions", "meshes", "bodies", "contact", "problem", "assembly"),
    *("limit", "bounds", "adaptive", "ranges", "questions", "paths", "files", "pictures", "doors"),
)
"""Files and folders of lacore: each imports from those before it, and from its own."""
VERIFICATION = (
    *("defaults", "case", "cases", "catalogue", "runs", "verdicts", "evidence", "store", "fuzz"),
    *("perform", "campaigns", "progress", "analysis", "verify", "report", "problems"),
    *("conformance", "usage", "commands", "__main__", "case_checks"),
)
"""Those of verification, alike."""
HOUSES = {"lacore": LACORE, "verification": VERIFICATION}
SOLVER_WING = LACORE[LACORE.index("process") : LACORE.index("materials")]
MECHANICS_WING = LACORE[LACORE.index("materials") : LACORE.index("limit")]
NAMED = r"(lacore|backends|verification)[\w.]*:\w+"
SOLVERS = ("casadi", "clarabel", "cvxpy", "ecos", "highspy", "mosek", "osqp", "qoco", "scs")


@cache
def imports(path, run=False):
    """Packages and full names that a file imports, wherever in it, also by a string
    ``module:name``; `run`: but for types alone."""
    return [*_imports(path, run)]


def _imports(path, run):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    typed = {
        inner
        for node in ast.walk(tree)
        if run and isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if node in typed:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Constant) and re.fullmatch(NAMED, str(node.value)):
            yield node.value.replace(":", ".")


def files(folder):
    found = sorted((ROOT / folder).rglob("*.py"))
    assert found, f"no files in {folder}: the check would be empty"
    return [pytest.param(path, id=str(path.relative_to(ROOT))) for path in found]


def within(name, package):
    return name == package or name.startswith(f"{package}.")


@pytest.mark.parametrize("path", files("lacore"))
def test_the_core_knows_no_solver_and_no_case(path):
    banned = ("backends", "verification", *SOLVERS)
    assert not [name for name in imports(path) if any(within(name, b) for b in banned)]


@pytest.mark.parametrize("path", [*files("lacore"), *files("verification")])
def test_imports_run_one_way(path):
    """Wherever in a file they stand; of `from verification import progress` the room is that."""
    house, own = module_of(path).partition(".")[0], room_of(path)
    if own == "__init__":
        return  # the face
    order = HOUSES[house]
    seen = rooms_seen(path, house)
    assert [name for name in seen if order.index(name) > order.index(own)] == []


@pytest.mark.parametrize("path", files("lacore"))
def test_what_knows_no_mesh_and_what_knows_no_loop_meet_in_limit(path):
    own, seen = room_of(path), rooms_seen(path, "lacore")
    for wing, other in ((SOLVER_WING, MECHANICS_WING), (MECHANICS_WING, SOLVER_WING)):
        assert own not in wing or not seen & set(other)


@pytest.mark.parametrize(
    "view", [views.picture, views.section, views.animation, views.files, views.scene]
)
def test_every_door_opens(view):
    """It names both sides; of a class or a function that was renamed nobody would notice."""
    assert view.makers
    for kind, maker in view.makers.items():
        assert isinstance(resolve_name(kind), type)
        assert callable(resolve_name(maker))


@pytest.mark.parametrize("house", HOUSES)
def test_every_room_has_its_place(house):
    there = {room_of(path) for path in (ROOT / house).rglob("*.py")}
    assert there - {"__init__"} == set(HOUSES[house])


def room_of(path):
    """The file or folder of its house that a file is or lies in."""
    return module_of(path).split(".")[1]


def rooms_seen(path, house):
    """The files and folders of a house that a file imports from; the version is in none of them."""
    seen = {name.split(".")[1] for name in imports(path) if name.startswith(f"{house}.")}
    return seen - {"__version__"}


@pytest.mark.parametrize("house", ["lacore", "verification", "backends"])
def test_no_file_needs_itself(house):
    """Of modules, inside of rooms too; imports for types alone need nothing."""
    found = {module_of(path): path for path in (ROOT / house).rglob("*.py")}
    needs = {
        name: {known(seen, found) for seen in imports(path, run=True)} - {name, None}
        for name, path in found.items()
        if not name.endswith("__init__")
    }
    TopologicalSorter(needs).prepare()  # CycleError names the files of a circle


def module_of(path):
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def known(name, found):
    """The module that holds a name, if it is one of those."""
    return next((n for n in (name, name.rpartition(".")[0]) if n in found), None)


@pytest.mark.parametrize("house", HOUSES)
def test_a_room_is_seen_at_a_glance(house):
    """Cases are as many as there are."""
    crowded, long = {}, {}
    for folder in {path.parent for path in (ROOT / house).rglob("*.py")}:
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
    asked = {}
    for path in sorted((ROOT / "lacore").rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance":
                named = {own.id for own in ast.walk(node.args[1]) if isinstance(own, ast.Name)}
                if named & KINDS_OF_THINGS:
                    asked[f"{path.relative_to(ROOT)}:{node.lineno}"] = ast.unparse(node)
    assert len(asked) <= MOST_QUESTIONS, asked


def test_the_list_of_slow_tests_names_tests():
    """Of one that was renamed nobody would notice that it is fast again."""
    for line in (ROOT / "tests" / "slow.txt").read_text(encoding="utf-8").splitlines():
        file, _, name = line.partition("::")
        function = name.partition("[")[0]
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8") or not name, line


def test_pictures_of_the_rooms_are_those_of_the_code():
    """Drawn by docs/architecture.py, which reads the lists above and the imports."""
    for name, drawn in script_of("architecture").pictures().items():
        kept = (ROOT / "docs" / name).read_text(encoding="utf-8")
        assert kept == drawn, (
            f"docs/{name} shows other rooms or imports: run python docs/architecture.py"
        )


def test_a_solve_passes_through_few_rooms():
    """Counted by docs/way.py; the flat files of the contract are one."""
    way = script_of("way")
    assert len(set(map(way.room, way.called(way.block())))) <= MOST_ROOMS


def script_of(name):
    """A script of docs, as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script


@pytest.mark.parametrize("path", files("backends"))
def test_a_backend_knows_the_core_only(path):
    """And private modules beside it, which are no backends: what several share exists once."""
    banned = ("backends", "verification", "skfem", "matplotlib")
    names = [name for name in imports(path) if not name.startswith("backends._")]
    assert not [name for name in names if any(within(name, b) for b in banned)]


@pytest.mark.parametrize("path", files("verification/cases"))
def test_a_case_knows_no_backend(path):
    banned = ("backends", *SOLVERS)
    assert not [name for name in imports(path) if any(within(name, b) for b in banned)]


@pytest.mark.parametrize("path", files("verification"))
def test_the_harness_knows_no_backend_by_name(path):
    """Cases say what cannot solve them, random problems what their second opinion is."""
    if room_of(path) in ("cases", "fuzz"):
        return
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    names = set(tomllib.loads(text)["project"]["entry-points"]["lacore.backends"])
    tree = ast.parse(path.read_text(encoding="utf-8"))
    said = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    assert not said & names


def test_the_start_knows_the_standard_library_only():
    """It speaks of our packages where they cannot be imported, and opens the command line."""
    names = {name for path in (ROOT / "lacore_start").glob("*.py") for name in imports(path)}
    ours = {
        "lacore_start",
        "lacore_start.hidden",
        "verification.commands.cli",
        "verification.commands.cli.main",
    }
    assert not {name.partition(".")[0] for name in names - ours} - sys.stdlib_module_names


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
        ("import lacore", ("numpy", "lacore.errors", "backends", "verification")),
        ("import lacore.process.child_process", ("numpy", "backends", "verification")),
        ("import lacore.process.isolation", ("pandas", "skfem", "backends", "verification")),
        ("import lacore as la; dir(la); la.InputError; la.Status", ("lacore.limit.solve",)),
        ("import verification", ("numpy", "lacore", "backends")),
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
from verification.commands.cli import main
for arguments in {asked!r}:
    try:
        main(arguments)
    except SystemExit:
        pass"""
    banned = [*HEAVY, "backends", "lacore.limit.solve", "verification.perform.processes"]
    assert loaded_of(call, [*banned, "verification.cases.prandtl_punch"]) == []


def test_every_name_that_lacore_promises_is_there():
    """Also where a function has the name of its module, and that was imported before."""
    code = """
import lacore.ranges.coulomb, lacore.bounds.gap_identity, lacore.paths.sequential
import lacore as la
from types import ModuleType
found = {name: getattr(la, name) for name in la.__all__}
print(sorted(name for name, value in found.items() if isinstance(value, ModuleType)))
"""
    assert printed_by(code) == "['hardening', 'masonry', 'masonry3d', 'meshes', 'sections']"


def loaded_of(code, banned):
    """Which of some modules a fresh interpreter has loaded after running code."""
    asked = f"import sys; print([name for name in {banned!r} if name in sys.modules])"
    return ast.literal_eval(printed_by(f"{code}\n{asked}").splitlines()[-1])


def printed_by(code):
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return run.stdout.strip()


@pytest.mark.parametrize("room", ROOMS)
def test_what_is_imported_is_installed_with_us(room):
    """Packages of others are named in pyproject.toml; this environment may have them by luck."""
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = [*stated["dependencies"], *chain(*stated["optional-dependencies"].values())]
    named = {_normal(re.split(r"[^\w.-]", line)[0]) for line in lines}
    owners = owners_of_packages()
    missing = {
        f"{path.relative_to(ROOT)}: {top}"
        for path in (ROOT / room).rglob("*.py")
        for top in {name.split(".")[0] for name in imports(path)}
        if top not in (*sys.stdlib_module_names, *ROOMS)
        and not named & set(map(_normal, owners.get(top, [top])))
    }
    assert not missing


@cache
def owners_of_packages():
    return packages_distributions()


def _normal(distribution):
    return distribution.lower().replace("_", "-")
