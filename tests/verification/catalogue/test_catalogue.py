"""Cases of others: what is found, what is refused and how; tags; what built-in cases say."""

import json
import os
import pickle
import subprocess
import sys
from importlib.metadata import EntryPoint

import pytest
from click.testing import CliRunner

import lacore as la
import lacore_verification.catalogue.plugins as plugins
from lacore_verification.case import KINDS
from lacore_verification.catalogue.catalogue import Catalogue, catalogue, find, tagged
from lacore_verification.catalogue.checks import check
from lacore_verification.catalogue.plugins import gather
from lacore_verification.commands.cli import main
from lacore_verification.harness.campaigns.comparison import plan
from tests.conftest import ROOT
from tests.processes import SOURCES

CASES = list(catalogue().values())
EXAMPLES = ROOT / "examples" / "cases"
GOOD = (EXAMPLES / "block_on_step.py").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def fresh_imports(monkeypatch):
    """Each test imports its own files."""
    before = set(sys.modules)
    monkeypatch.setattr(sys, "path", list(sys.path))
    yield
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", "")).endswith("planted.py"):
            del sys.modules[name]
    sys.modules.pop("block_on_step", None)


@pytest.fixture
def planted(tmp_path):
    """A folder with one case file; the good one, with parts of it replaced."""

    def plant(*replacements, name="planted.py", text=GOOD):
        for old, new in replacements:
            assert old in text, f"{old!r} is not in the example"
            text = text.replace(old, new)
        (tmp_path / name).write_text(text, encoding="utf-8")
        return tmp_path

    return plant


def run(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


# ---- built-in cases


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_built_in_cases_pass_the_check_for_those_of_others(case):
    check(case)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_tags_say_what_the_problems_consist_of(case):
    """Over all variants: what any of them has."""
    kinds = set()
    for variant in case.variants:
        problem = case.problem(variant, next(iter(case.meshes)))
        for body in problem.bodies.values():
            kinds.add({"Body": "continuum", "Frame": "frames"}.get(type(body).__name__, "blocks"))
            if isinstance(body, la.BlockAssembly | la.BlockAssembly3D) and body.joints.count:
                kinds.add("contact")
        stated = case.following_of(variant) if case.path else None
        if problem.interfaces or (stated and (stated.approaching or stated.tools)):
            kinds.add("contact")
    assert kinds
    assert kinds == set(case.tags) & {"continuum", "blocks", "frames", "contact"}


def test_runs_go_to_other_processes():
    for run in plan(backends=["clarabel"]):
        copy = pickle.loads(pickle.dumps(run))
        assert copy.case.build is run.case.build


def test_every_case_has_a_kind():
    assert all(set(case.tags) & set(KINDS) for case in CASES)


def test_tags_filter():
    assert "structured-sweep" in {case.id for case in tagged(catalogue(), ["blocks", "frames"])}
    assert tagged(catalogue(), []) == CASES
    with pytest.raises(la.InputError, match="did you mean 'blocks'"):
        tagged(catalogue(), ["block"])
    with pytest.raises(la.InputError, match="no case has all"):
        tagged(catalogue(), ["frames", "soil"])


def test_cases_lists_tags_and_filters_by_them():
    listed = json.loads(run("cases", "--json", "--tag", "continuum,contact").stdout)
    found = {entry["id"] for entry in listed}
    assert found == {case.id for case in CASES if {"continuum", "contact"} <= set(case.tags)}
    assert "shear-patch" in found
    assert not {"prandtl-punch", "wall-1"} & found  # without contact, without a continuum
    assert "tags: frames, contact" in run("cases", "--tag", "frames").stdout
    assert run("cases", "--tag", "nonsense").exit_code == 2


# ---- cases of others


@pytest.mark.slow
def test_the_example_runs_from_the_command_line(tmp_path):
    """In a process of its own, as a user would."""
    command = [sys.executable, "-m", "lacore_verification", "compare", "block-on-step", "--json"]
    options = ["--cases", str(EXAMPLES), "--backends", "clarabel,highs", "--out", str(tmp_path)]
    done = subprocess.run([*command, *options], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    assert [row["verdict"] for row in rows] == ["pass"] * 4
    assert rows[0]["load_factor"] == pytest.approx(2 * 1 / 2 / 0.8, rel=1e-6)
    assert "block-on-step" in (tmp_path / "index.html").read_text(encoding="utf-8")


def test_cases_of_a_folder_come_after_ours_and_ours_stay_as_they_are():
    known = gather([EXAMPLES])
    assert list(known) == [*catalogue(), "block-on-step"]
    assert known.sources["block-on-step"] == str(EXAMPLES / "block_on_step.py")
    assert "block-on-step" not in catalogue()
    with pytest.raises(la.InputError, match="unknown name"):
        find("block-on-step")
    assert find("block-on-step:tall", known)[1][0].name == "tall"
    assert {run.case.id for run in plan(["block-on-step"], ["clarabel"], known=known)} == {
        "block-on-step"
    }


def test_a_file_may_hold_several_cases(planted):
    more = (
        "\nfrom dataclasses import replace\nCASES = (CASE, replace(CASE, id='another'))\ndel CASE\n"
    )
    assert {"block-on-step", "another"} <= set(gather([planted(text=GOOD + more)]))


def test_other_processes_import_a_case_by_the_same_path(planted):
    """As child interpreters do: PYTHONPATH is the path of this one."""
    known = gather([planted()])
    assert pickle.loads(pickle.dumps(known["block-on-step"])).build is known["block-on-step"].build
    code = "import pickle, sys; print(pickle.load(sys.stdin.buffer).title)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=pickle.dumps(known["block-on-step"]),
        env={"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
    )
    assert done.stdout.decode().strip() == known["block-on-step"].title, done.stderr.decode()


def test_private_files_are_left_alone(planted):
    folder = planted()
    (folder / "_helper.py").write_text("raise RuntimeError('imported')")
    assert "block-on-step" in gather([folder])


def test_what_a_file_prints_stays_out_of_json(planted):
    listed = run("cases", "--json", "--cases", planted(text=GOOD + "\nprint('hello')\n"))
    assert "block-on-step" in {entry["id"] for entry in json.loads(listed.stdout)}


BAD = {
    "syntax": ([("import lacore as la", "import import")], "planted.py, line 14: SyntaxError"),
    "import": (
        [("import lacore as la", "import lacore as la\n1 / 0")],
        "planted.py, line 15: ZeroDivisionError: division by zero; correct the file",
    ),
    "exit": ([("import lacore as la", "raise SystemExit(3)")], "SystemExit: 3; correct the file"),
    "missing module": (
        [("import lacore as la", "import no_such_thing_at_all")],
        "ModuleNotFoundError: No module named 'no_such_thing_at_all'",
    ),
    "no case": ([("CASE = Case(", "ANOTHER = Case(")], "CASE: there is none, nor CASES; define"),
    "both": ([("CASE = Case(", "CASES = ()\nCASE = Case(")], "CASES is there too"),
    "wrong type": ([("CASE = Case(", "CASE = dict(")], "CASE = 'dict': not a Case; give a Case"),
    "empty": ([("CASE = Case(", "CASES = ()\n_ = Case(")], "not a case; give a tuple of Cases"),
    "mixed": ([("CASE = Case(", "CASES = (1,)\n_ = Case(")], "'int': not a case; give a tuple"),
    "missing field": ([('    unit="N/m",\n', "")], "TypeError: Case.__init__() missing 1 required"),
    "id taken": (
        [('id="block-on-step"', 'id="stack-n"')],
        "'stack-n': is that of a case of lacore",
    ),
    "id": ([('id="block-on-step"', 'id="a:b"')], "Case.id = 'a:b': not a name that"),
    "id of a path": ([('id="block-on-step"', 'id="../up"')], "Case.id = '../up': not a name that"),
    "title": ([('"A block is pushed over a step"', '" "')], "Case.title = ' ': says nothing"),
    "title in lines": ([("pushed over a step", "pushed\\nover")], "Case.title: has several lines"),
    "explanation": ([("explanation=__doc__", "explanation=None")], "Case.explanation = 'NoneType'"),
    "tags": ([('("blocks", "contact", "closed form")', '"blocks"')], "Case.tags = 'blocks'"),
    "no meshes": ([("    build=build", "    meshes={},\n    build=build")], "names no level"),
    "mesh": (
        [("    build=build", "    meshes={'coarse': {'n': 2}},\n    build=build")],
        "Case.build: does not go with variant 'square': got an unexpected keyword argument 'n'",
    ),
    "mesh and parameter": (
        [("    build=build", "    meshes={'coarse': {'h': 2}},\n    build=build")],
        "Case.meshes['coarse'] = 'h': is a parameter of variant 'square' too",
    ),
    "parameter nan": ([('{"h": 2.0}', '{"h": float("nan")}')], "parameters['h'] = nan: not a"),
    "levels": (
        [('{"h": 1.0})', '{"h": 1.0}, meshes="fine")')],
        "Case.variants[0].meshes = 'fine': not names in a tuple; write ('fine',)",
    ),
    "no load factor": (
        [("Reference(value", "Reference(float('inf')")],
        "value = inf: no load factor that a solve can end with; give the status too",
    ),
    "level": (
        [('{"h": 1.0})', '{"h": 1.0}, meshes=("fine",))')],
        "Case.variants[0].meshes = 'fine': unknown level; known names: blocks",
    ),
    "no variants": ([("variants=(Var", "variants=(),\n    sweep=(Var")], "variants: there is none"),
    "variant": ([('Variant("tall", {"h": 2.0})', '"tall"')], "Case.variants[1] = 'str': not a"),
    "variant twice": ([('"tall"', '"square"')], "Case.variants[1].name = 'square': is there twice"),
    "parameter name": (
        [('{"h": 2.0}', '{"height": 2.0}')],
        "Case.build: does not go with variant 'tall'",
    ),
    "parameter": ([('{"h": 2.0}', '{"h": [2.0]}')], "parameters['h'] = 'list': not a number"),
    "no function": ([("build=build", "build=3")], "Case.build = 'int': not a function"),
    "lambda": (
        [("band=band", "band=lambda elements, h: rigid(2.0)")],
        "Case.band: other processes cannot find it by name; define it at the top level",
    ),
    "reference raises": (
        [("(h - STEP)\n", "(h - h)\n")],
        "Case.reference: fails for variant 'square': ZeroDivisionError",
    ),
    "reference type": (
        [("return Reference(value, ", "return (value, ")],
        "Case.reference, variant 'square' = 'tuple': no Reference",
    ),
    "reference value": ([("Reference(value", "Reference('1'")], "value = '1': not a number"),
    "reference width": ([('"exact")', '"exact", half_width=-1.0)')], "not a distance"),
    "reference interval": ([('"exact")', '"exact", up_to=0.0)')], "up_to = 0.0: not above value"),
    "associated": ([('"exact")', '"exact", associated=float("nan"))')], "associated = nan: not a"),
    "source": ([('"moments by hand"', '""')], "source = '': says nothing"),
    "band raises": (
        [("return rigid(dead=WEIGHT)", "raise OSError('x')")],
        "band: fails for variant",
    ),
    "band type": ([("return rigid(dead=WEIGHT)", "return 1e-6")], "= 'float': no Band; return a"),
    "band value": (
        [("return rigid(dead=WEIGHT)", 'return Band(-1.0, 0.0, "so")')],
        "below = -1.0: not a size of an error; give a finite number >= 0",
    ),
    "band reason": ([("return rigid(dead=WEIGHT)", 'return Band(0, 0, "")')], "reason = '': says"),
    "sweep": ([("    build=build", '    sweep="mu",\n    build=build')], "sweep = 'mu': no number"),
    "order": (
        [("    build=build", "    order=band,\n    build=build")],
        "Case.order: does not go with variant 'square': missing a required argument",
    ),
}


@pytest.mark.parametrize(("replacements", "message"), BAD.values(), ids=BAD)
def test_bad_files_get_one_sentence(planted, replacements, message):
    folder = planted(*replacements)
    done = run("cases", "--cases", folder)
    assert done.exit_code == 2, done.output
    assert done.stdout == ""
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith(f"Error: {folder / 'planted.py'}"), line
    assert message in line
    assert "; " in line, "no fix"
    assert done.exc_info[0] is SystemExit


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ("3", "Case.bracket = 'int': no Bracketing; give a Bracketing, or None"),
        ("Bracketing(0.0)", "Case.bracket.target_width = 0.0: not a width"),
        ("Bracketing(max_elements=1e4)", "Case.bracket.max_elements = 10000.0: not a positive"),
        ("Bracketing(mesh='bloks')", "Case.bracket.mesh = 'bloks': unknown level; did you mean"),
        ("Bracketing(below=float('nan'))", "Case.bracket.below = nan: not a size of an error"),
        ("Bracketing(above=0.1)", "Case.bracket.reason = '': says nothing"),
    ],
)
def test_a_bracket_says_what_it_must(planted, stated, message):
    imported = (
        "import lacore as la\n",
        "import lacore as la\nfrom lacore_verification.case.band import Bracketing\n",
    )
    folder = planted(imported, ("build=build", f"build=build,\n    bracket={stated}"))
    done = run("cases", "--cases", folder)
    assert done.exit_code == 2
    assert message in done.stderr


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ("3", "Case.first = 'int': not a First; give a First"),
        ("First(variant='squar')", "Case.first.variant = 'squar': unknown variant; did you mean"),
        ("First(meshes='fine')", "Case.first.meshes = 'fine': not names in a tuple; write"),
        ("First(meshes=('bloks',))", "Case.first.meshes = 'bloks': unknown level; did you mean"),
        ("First(bracket=-1.0)", "Case.first.bracket = -1.0: not a width; give a number >= 0"),
        ("First(bracket=0.1)", "Case.first.bracket = 0.1: no bracket can be computed"),
        ("First(meshes=())", "Case.first.meshes = (): names no mesh, and there is no bracket"),
    ],
)
def test_wrong_runs_of_the_first_comparison_are_named(planted, stated, message):
    imported = (
        "import lacore as la\n",
        "import lacore as la\nfrom lacore_verification.case import First\n",
    )
    folder = planted(imported, ("build=build", f"build=build,\n    first={stated}"))
    done = run("cases", "--cases", folder)
    assert done.exit_code == 2
    assert message in done.stderr


def test_an_order_needs_a_ladder(planted):
    order = (
        "def order(h):\n    from lacore_verification.case import Order\n"
        "    return Order([{}, {}, {}], 1.0, 0.1, 'why')\n\n\nCASE = Case("
    )
    folder = planted(("CASE = Case(", order), ("build=build", "build=build,\n    order=order"))
    assert "meshes = 3: fewer than 4 sizes" in run("cases", "--cases", folder).stderr


@pytest.mark.parametrize("name", ["random.py", "numpy.py", "lacore.py", "no-name.py", "1st.py"])
def test_names_that_import_something_else_are_refused(planted, name):
    done = run("cases", "--cases", planted(name=name))
    assert done.exit_code == 2
    assert name in done.stderr
    assert "rename" in done.stderr


def test_two_folders_with_one_file_name(planted, tmp_path):
    folder, other = planted(), tmp_path / "other"
    other.mkdir()
    (other / "planted.py").write_text(GOOD.replace("block-on-step", "another"))
    done = run("cases", "--cases", folder, "--cases", other)
    assert done.exit_code == 2
    assert f"the name 'planted' imports {folder / 'planted.py'} instead; rename" in done.stderr


def test_a_link_to_a_file_is_a_file(planted, tmp_path):
    (tmp_path / "links").mkdir()
    real = planted(name="real_planted.py") / "real_planted.py"
    (tmp_path / "links" / "planted.py").symlink_to(real)
    assert "block-on-step" in gather([tmp_path / "links"])


@pytest.mark.parametrize("kind", ["missing", "file", "empty", "with:colon"])
def test_folders_that_are_none(tmp_path, kind):
    place = tmp_path / kind
    if kind == "with:colon":
        if os.pathsep != ":":
            pytest.skip("paths are separated otherwise here")
        place.mkdir()
    if kind == "file":
        place.write_text("")
    elif kind == "empty":
        place.mkdir()
    done = run("compare", "--cases", place)
    assert done.exit_code == 2
    (line,) = done.stderr.strip().splitlines()
    assert line.startswith("Error: --cases = ")


# ---- entry points


@pytest.fixture
def installed(planted, monkeypatch):
    """As if packages with these entry points were installed; their modules are in a folder."""

    def install(**values):
        sys.path.append(str(planted()))
        entries = [EntryPoint(name, value, plugins.GROUP) for name, value in values.items()]
        monkeypatch.setattr(plugins, "entry_points", lambda group: entries)

    return install


def test_cases_of_packages_are_found(installed):
    installed(mine="planted:CASE")
    assert "block-on-step" in gather()
    assert "block-on-step" in run("cases").stdout


def test_an_installed_package_is_found_by_its_metadata(planted):
    """A distribution as an installer leaves it, read by another process."""
    site = planted()
    about = site / "mine-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: mine\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[lacore.cases]\nmine = planted:CASE\n")
    done = subprocess.run(
        [sys.executable, "-m", "lacore_verification", "cases", "--json"],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([*SOURCES, str(site)])},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    (entry,) = [e for e in json.loads(done.stdout) if e["id"] == "block-on-step"]
    assert entry["source"] == "mine, entry point 'mine' of lacore.cases"


def test_a_broken_package_hinders_no_one_else(installed):
    installed(broken="no_such_module_at_all:CASE", fine="planted:CASE", wrong="planted:WIDTH")
    done = run("cases", "--json")
    assert done.exit_code == 0
    assert "block-on-step" in {entry["id"] for entry in json.loads(done.stdout)}
    first, second = done.stderr.strip().splitlines()
    assert first.startswith("warning: cases omitted: a package, entry point 'broken' of lacore")
    assert "entry point 'wrong'" in second


def test_a_broken_package_that_is_named_is_an_error(installed):
    installed(broken="no_such_module_at_all:CASE")
    done = run("compare", "broken")
    assert done.exit_code == 2
    assert "ModuleNotFoundError" in done.stderr.splitlines()[-1]


def test_the_catalogue_is_a_value():
    known = gather()
    assert isinstance(known, Catalogue)
    assert dict(known) == dict(known.cases) == dict(catalogue())
