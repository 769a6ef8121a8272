"""llms.txt is that of the code: its names exist, and commands do what it says of them."""

import json
import re
import tomllib
from importlib.resources import files

import pytest
from click.testing import CliRunner

import lacore as la
from lacore_verification.commands.cli import main
from lacore_verification.report.problems import starters
from tests.conftest import ROOT
from tests.test_layers import script_of

SCRIPT = script_of("llms")
TEXT = files("lacore").joinpath("llms.txt").read_text(encoding="utf-8")


def test_it_is_up_to_date():
    assert SCRIPT.text() == TEXT, "the code has changed: run python docs/llms.py"


def test_it_is_part_of_the_wheel():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "*.txt" in project["tool"]["setuptools"]["package-data"]["*"]


def test_names_exist():
    assert len(SCRIPT.NAMES) == 10
    for name in re.findall(r"`la\.(\w+)", TEXT):
        assert name in la.__all__


def test_every_command_is_listed():
    assert re.findall(r"^- `lacore (\w+)`", TEXT, re.MULTILINE) == list(main.commands)


@pytest.mark.parametrize("command", [["cases"], ["new"]])
def test_commands_print_one_json_document(command):
    ran = CliRunner().invoke(main, [*command, "--json"])
    assert ran.exit_code == 0
    json.loads(ran.stdout)


@pytest.mark.parametrize(
    ("code", "command"),
    [
        (0, ["new"]),
        (0, ["--help"]),
        (2, ["compar"]),
        (2, ["new", "fotting"]),
        (2, ["solve", "missing.toml"]),
    ],
)
def test_exit_codes(code, command):
    """1 and 130 are tested in tests/verification/report/problems/test_solve.py."""
    assert code in SCRIPT.CODES
    assert CliRunner().invoke(main, command).exit_code == code


def test_keys_of_starters_are_listed():
    listed = set(re.findall(r"(\w+)\*?[,\n ]", TEXT))
    for name in starters.titles():
        file = tomllib.loads(starters.text(name))
        tables = [file, *file["bodies"].values(), *file.get("supports", ())]
        tables += [*file.get("reference_loads", ()), *file.get("dead_loads", ())]
        for table in tables:
            assert {*table} <= listed, name
