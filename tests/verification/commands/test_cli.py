"""The commands as a user meets them."""

import json
import re

import pytest

import lacore as la
from lacore_verification import conformance
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.commands import doctor
from lacore_verification.commands.options import strict
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.runs.run import Run
from tests.verification.command_line import lacore as run
from tests.verification.harness.perform.test_harness import VARIANT, wrong_case

# A case of each kind: runs and pictures take time, and that every case runs is tested with cases.
SHOWN = [catalogue()[name] for name in ("deformable-block", "prandtl-punch", "wall-1")]
RUN = [
    *(f"{case.id}:{case.variants[0].name}" for case in SHOWN),
    "deformable-block:crushing",
    "deformable-block:mu-0.7",
]
PLANNED = plan(RUN, ["clarabel"], ["coarse"])


def strict_json(text):
    def refuse(name):
        raise AssertionError(f"{name} is not JSON")

    return json.loads(text, parse_constant=refuse)


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    out = tmp_path_factory.mktemp("compare")
    options = ("--backends", "clarabel", "--meshes", "coarse", "--out", out)
    return run("compare", *RUN, *options), out


def test_compare_answers_on_one_screen(compared):
    result, _ = compared
    assert result.exit_code == 0, result.output
    assert re.search(
        r"^prandtl-punch:smooth +5\.141593 +<= .* 1 of 1 .* pass$", result.stdout, re.M
    )
    round_off = r"^deformable-block:crushing .* +0 % +[\d.]+ % "  # of neither sign
    assert re.search(round_off, result.stdout, re.M)
    lines = result.stdout.splitlines()
    assert len(lines) <= 60
    assert lines[-1].startswith("Next:")
    assert max(map(len, result.stdout.split("Report:")[0].splitlines())) <= 120


def test_full_prints_every_run(tmp_path):
    again = run("compare", "deformable-block:crushing", "--backends", "clarabel",
                "--meshes", "coarse", "--out", tmp_path, "--full")  # fmt: skip
    assert re.search(r"coarse +clarabel +certified +3\.000000 +interval .* pass", again.stdout)
    assert max(map(len, again.stdout.split("Report:")[0].splitlines())) <= 120


def test_all_and_names_contradict_each_other(tmp_path):
    result = run("compare", "shear-patch", "--all", "--out", str(tmp_path / "new"))
    assert result.exit_code == 2
    assert "--all" in result.stderr


def test_compare_writes_rows_pictures_and_page(compared):
    _, out = compared
    assert (out / "results.csv").read_text().count("\n") == 1 + len(PLANNED)
    assert (out / "pictures" / "prandtl-punch-smooth.png").read_bytes().startswith(b"\x89PNG")
    assert "deformable-block-sweep" not in (out / "index.html").read_text(encoding="utf-8")
    assert "Load factor against mu" in (out / "cases" / "deformable-block.html").read_text()


def test_a_comparison_states_its_settings_and_the_noise_of_the_machine(compared):
    _, out = compared
    settings = (out / "settings.csv").read_text().splitlines()
    assert settings[0] == "backend,setting,option,value,default,changed"
    assert settings[1].startswith("clarabel,default,tolerance,1e-10,1e-10,False")
    index = (out / "index.html").read_text(encoding="utf-8")
    assert 'id="settings"' in index
    assert 'href="settings.csv"' in index
    assert re.search("The short solve was repeated|The noise is unknown", index)
    head = (out / "results.csv").read_text().partition("\n")[0].split(",")
    times = {"compile_time", "solver_time", "reported_time", "calibration_before", "options"}
    assert times <= set(head)


def test_pages_have_every_case_that_was_run_and_load_what_is_beside_them(compared):
    _, out = compared
    index = (out / "index.html").read_text(encoding="utf-8")
    for case in SHOWN:
        assert f'href="cases/{case.id}.html"' in index
    pages = [*out.rglob("*.html")]
    assert len(pages) > len(SHOWN)
    for path in pages:
        page = path.read_text(encoding="utf-8")
        for link in re.findall(r"""(?:src|href|action|data)\s*=\s*["']([^"'#]*)""", page):
            target = (path.parent / link).resolve()
            assert not link or (target.is_file() and target.is_relative_to(out.resolve())), link
        assert "://" not in page
        assert "@import" not in page
        assert not re.search(r"url\((?!#)", page)
        assert "default-src 'none'" in page
    # A thirtieth of what is allowed for each case that is run with all backends on all meshes.
    assert len(index) < 1_000_000


@pytest.fixture(scope="module")
def wrong(tmp_path_factory):
    """A comparison with a wrong reference, and a title that is a script."""
    case = wrong_case()
    object.__setattr__(case, "title", "<script>planted</script>")
    runs = [Run(case, VARIANT, "coarse", "clarabel")]
    out = tmp_path_factory.mktemp("wrong")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lacore_verification.harness.campaigns.overview.everything", lambda *_: runs)
        return run("compare", "--all", "--out", out), out


def test_page_escapes_what_it_shows(wrong):
    _, out = wrong
    page = (out / "index.html").read_text(encoding="utf-8")
    assert "<script>planted" not in page
    assert "&lt;script&gt;planted" in page


def test_wrong_result_is_exit_code_1(wrong):
    result, _ = wrong
    assert result.exit_code == 1
    assert "1 FAIL" in result.stdout


def test_json_is_one_strict_document(tmp_path):
    result = run(
        "compare", "shear-patch", "--backends", "clarabel", "--meshes", "coarse",
        "--out", str(tmp_path), "--json",
    )  # fmt: skip
    document = strict_json(result.stdout)
    assert document["summary"] == {
        "passed": 2,
        "failed": 0,
        "skipped": 0,
        "no_result": 0,
        "bound_only": 0,
        "no_reference": 0,
    }
    (first, _) = document["rows"]
    assert first["alpha_reg"] is None
    assert first["load_factor"] == pytest.approx(0.32)
    (case, _) = document["cases"]  # as on the terminal
    assert (case["case"], case["variant"]) == (first["case"], first["variant"])
    assert (case["agreeing"], case["asked"], case["verdict"]) == (1, 1, "pass")
    assert (case["expected"], case["lower"], case["shortfalls"]) == (first["expected"], None, [])
    assert abs(case["error"]) <= abs(case["allowed"])


def test_lists_are_json_too():
    assert {entry["id"] for entry in strict_json(run("cases", "--json").stdout)} == set(catalogue())
    assert "clarabel" in {entry["name"] for entry in strict_json(run("backends", "--json").stdout)}


def test_backends_and_their_variants():
    records = {entry["name"]: entry for entry in strict_json(run("backends", "--json").stdout)}
    assert records["clarabel"]["solves"] == "exact"
    assert records["clarabel"]["version"].startswith("Clarabel ")
    assert records["clarabel"]["state"] == "ready"
    assert records["highs"]["takes"] == "linear programs"
    assert records["newton"]["solves"] == "regularised"
    assert "1200 unknowns" in records["slsqp"]["takes"]
    assert records["cvxpy:SCS"]["warm_start"] == "yes"
    assert records["cvxpy:SCS"]["hardening"] == "yes"
    assert records["cvxpy:HIGHS"]["hardening"] == records["ipopt-static"]["hardening"] == "no"
    table = run("backends").stdout
    for name, record in records.items():
        assert re.search(rf"^{name} .*(ready|missing)$", table, re.MULTILINE), name
        assert record["state"] == "ready" or record["state"] in table


def test_conformance_prints_a_line_a_program():
    result = run("conformance", "highs")
    assert result.exit_code in (0, 1)
    assert re.search(r"^  friction +pass +6 [a-z ]+\S+ +(1.0e-07|3.2e-04)$", result.stdout, re.M)
    assert "skipped: backend 'highs' takes linear programs" in result.stdout


def found(*verdicts):
    return (
        conformance.run("clarabel", programs=["friction"])
        .head(len(verdicts))
        .assign(verdict=verdicts, message="said")
    )


@pytest.mark.parametrize(("verdict", "code"), [("pass", 0), ("skipped", 0), ("FAIL", 1)])
def test_conformance_exit_code_and_json(monkeypatch, verdict, code):
    findings = found("pass", verdict)
    monkeypatch.setattr(conformance, "run", lambda name: findings)
    result = run("conformance", "clarabel", "--json")
    assert result.exit_code == code
    document = strict_json(result.stdout)
    assert sum(document["summary"].values()) == 2
    assert [row["verdict"] for row in document["rows"]] == ["pass", verdict]
    assert {"backend", "program", "check", "value", "allowed"} <= document["rows"][0].keys()
    assert run("conformance", "clarabel").exit_code == code


def test_conformance_of_an_unknown_backend():
    result = run("conformance", "clarbel")
    assert result.exit_code == 2
    assert "did you mean 'clarabel'?" in result.stderr


def test_conformance_of_a_backend_that_is_not_here(monkeypatch):
    def missing(name):
        raise la.CapabilityError(f"backend {name!r} is not available: no licence")

    monkeypatch.setattr(la, "find_backend", missing)
    result = run("conformance", "cvxpy:MOSEK")
    assert result.exit_code == 2
    assert "no licence" in result.stderr
    assert "Traceback" not in result.output


@pytest.mark.parametrize("healthy", [True, False])
def test_doctor(monkeypatch, healthy):
    verdict = {"backend": "clarabel", "self_test": "pass" if healthy else "FAIL", "remedy": ""}
    monkeypatch.setattr(doctor, "self_tests", lambda _: [verdict])
    result = run("doctor", "--json")
    document = strict_json(result.stdout)
    assert document["healthy"] is healthy
    assert "numpy" in {entry["package"] for entry in document["packages"]}
    assert document["backends"] == [verdict]
    assert result.exit_code == (0 if healthy else 1)
    shown = run("doctor")
    assert ("the installation works" in shown.stdout) is healthy
    assert "openblas" in shown.stdout or not document["libraries"]


def test_infinity_is_strict_json():
    assert strict({"a": [float("nan"), float("inf")]}) == {"a": [None, "inf"]}


@pytest.mark.parametrize(
    ("arguments", "fix"),
    [
        (["prandl-punch"], "did you mean 'prandtl-punch'?"),
        (["prandtl-punch:smoth"], "did you mean 'smooth'?"),
        (["--backends", "clarbel"], "did you mean 'clarabel'?"),
        (["--backends", "cvxpy:SCSS"], "did you mean 'SCS'?"),
        (["--backends", "slsqp:fast"], "has no variants"),
        (["--time-limit", "nan"], "--time-limit"),
        (["--time-limit", "inf"], "--time-limit"),
        (["shear-patch", "--meshes", "corse"], "did you mean 'coarse'?"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(tmp_path, arguments, fix):
    result = run("compare", *arguments, "--out", str(tmp_path / "new"))
    assert result.exit_code == 2
    assert fix in result.stderr
    assert "Traceback" not in result.output
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "new").exists()


def test_unwritable_folder_is_exit_code_2(tmp_path):
    (tmp_path / "file").write_text("")
    result = run("compare", "shear-patch", "--out", str(tmp_path / "file" / "below"))
    assert result.exit_code == 2
    assert "is a file; give a folder" in result.stderr


@pytest.mark.parametrize(
    "command", ["compare", "cases", "backends", "conformance", "doctor", "verify"]
)
def test_help_says_what_a_command_does(command):
    result = run(command, "--help")
    assert result.exit_code == 0
    assert "--json" in result.stdout


def test_reports_manuals_and_exports_are_json_too(compared, tmp_path):
    _, results = compared
    made = strict_json(run("report", results, "--out", tmp_path / "report", "--json").stdout)
    assert made["report"] == str(tmp_path / "report" / "index.html")
    assert made["summary"]["passed"] == len(PLANNED)
    options = ("wall-1", "--results", results, "--out", tmp_path / "manual", "--json")
    made = strict_json(run("manual", *options).stdout)
    assert (tmp_path / "manual" / "index.html").samefile(made["manual"])
    made = strict_json(run("export", "wall-1", "--out", tmp_path / "files", "--json").stdout)
    assert (tmp_path / "files" / "index.csv").samefile(made["index"])
    assert all((tmp_path / "files" / row["file"]).is_file() for row in made["rows"])
